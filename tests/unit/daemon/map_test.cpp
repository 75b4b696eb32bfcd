#include "daemon/map.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <boost/json.hpp>

#include "tests/unit/config/site.h"

namespace gateway {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

const std::string kMapped = R"(title = "t"
[tpdo1]
map = ["0x2021:02 u16"]
[signals.output_frequency]
object = "0x2021:02"
type = "u16"
scale = 0.01
unit = "Hz"
)";

config::Model line3(const std::string& more = "") {
  return config::model_of("[gateway]\nname = \"line3\"\n" + config::kBus +
                              "[[drive]]\nname = \"pump1\"\nnode = 5\nprofile = \"own\"\n" + more,
                          kMapped);
}

/// The text without the white space between its parts.
std::string compact(const std::string& json) {
  return boost::json::serialize(boost::json::parse(json));
}

TEST(MapAsJson, IsThatOfTheContract) {
  const std::string text = render_map(line3(), MapFormat::json);
  EXPECT_EQ(compact(text), compact(R"({"gateway": "line3", "base": "canopen/line3",
 "buses": [{"name": "can0", "bitrate": null, "load": null, "load_worst": null, "at_least": false}],
 "drives": [{"name": "pump1", "bus": "can0", "node": 5, "profile": "own", "modbus_unit": 5,
   "signals": [{"name": "output_frequency", "object": "0x2021:02", "type": "u16", "scale": 0.01, "unit": "Hz",
                "access": "read", "source": "tpdo1", "min": null, "max": null, "values": null,
                "modbus": {"kind": "register", "address": 2, "count": 1},
                "mqtt": {"topic": "canopen/line3/pump1/output_frequency", "set": null}, "unconfirmed": false}]}]})"));
  EXPECT_THAT(text, HasSubstr("\"scale\": 0.01,"));
}

TEST(MapAsJson, HasASignalALineAndItsKeysInOrder) {
  EXPECT_EQ(render_map(line3(), MapFormat::json),
            R"({"gateway": "line3", "base": "canopen/line3", "buses": [
  {"name": "can0", "bitrate": null, "load": null, "load_worst": null, "at_least": false}], "drives": [
  {"name": "pump1", "bus": "can0", "node": 5, "profile": "own", "modbus_unit": 5, "signals": [
    {"name": "output_frequency", "object": "0x2021:02", "type": "u16", "scale": 0.01, "unit": "Hz", )"
            R"("access": "read", "source": "tpdo1", "min": null, "max": null, "values": null, )"
            R"("modbus": {"kind": "register", "address": 2, "count": 1}, )"
            R"("mqtt": {"topic": "canopen/line3/pump1/output_frequency", "set": null}, "unconfirmed": false}]}]}
)");
}

TEST(Map, ListsTheAddressesOfTheFlatUnit) {
  const config::Model model = line3("flat = 3000\n[modbus]\nflat_unit = 1\n");
  const std::string json = compact(render_map(model, MapFormat::json));
  EXPECT_THAT(json, HasSubstr(R"("base":"canopen/line3","flat_unit":1,)"));
  EXPECT_THAT(json, HasSubstr(R"("modbus_unit":5,"flat":3000,)"));
  EXPECT_THAT(json, HasSubstr(R"("modbus":{"kind":"register","address":2,"count":1,"flat":3002})"));
  EXPECT_THAT(render_map(model, MapFormat::csv), HasSubstr("5: register 2; 1: register 3002,"));
  const config::Model alone = line3("unit = \"none\"\nflat = 3000\n[modbus]\nflat_unit = 1\n");
  EXPECT_THAT(render_map(alone, MapFormat::csv), HasSubstr(",1: register 3002,"));
  EXPECT_THAT(compact(render_map(alone, MapFormat::json)), HasSubstr(R"("modbus_unit":null,"flat":3000,)"));
}

TEST(MapAsJson, TellsWhatIsMissingByNull) {
  const config::Model model = line3(R"(unit = "none"
[drive.signals.control_command]
object = "0x2000:01"
type = "u8"
access = "write"
min = 0
max = 2.5
unit = "say \"go\""
values = { 0 = "stop", 1 = "go \\ run" }
[mqtt]
base = "plant"
)");
  const std::string text = render_map(model, MapFormat::json);
  EXPECT_THAT(text, HasSubstr("\"min\": 0, \"max\": 2.5, "));
  const auto root = boost::json::parse(text);
  EXPECT_EQ(root.at("base").as_string(), "plant/line3");
  const auto& drive = root.at("drives").at(0);
  EXPECT_TRUE(drive.at("modbus_unit").is_null());
  const auto& signals = drive.at("signals").as_array();
  const auto* const found = std::find_if(signals.begin(), signals.end(), [](const auto& signal) {
    return signal.at("name").as_string() == "control_command";
  });
  ASSERT_NE(found, signals.end());
  const auto& signal = *found;
  EXPECT_EQ(signal.at("unit").as_string(), "say \"go\"");
  EXPECT_EQ(signal.at("access").as_string(), "write");
  EXPECT_EQ(signal.at("source").as_string(), "sdo");
  EXPECT_EQ(signal.at("max").to_number<double>(), 2.5);
  EXPECT_EQ(signal.at("values").at("1").as_string(), "go \\ run");
  EXPECT_TRUE(signal.at("modbus").is_null());
  EXPECT_TRUE(signal.at("mqtt").at("topic").is_null());
  EXPECT_EQ(signal.at("mqtt").at("set").as_string(), "plant/line3/pump1/control_command/set");
}

TEST(MapAsJson, ShowsBitsAndWideValues) {
  const config::Model model = line3(
      "[drive.signals.running]\nfrom = \"output_frequency\"\nmask = 1\n[drive.signals.x]\nobject = "
      "\"0x1\"\ntype = \"u32\"\naddress = 200\n[mqtt]\nsignals = false\n");
  const auto root = boost::json::parse(render_map(model, MapFormat::json));
  const auto& signals = root.at("drives").at(0).at("signals").as_array();
  ASSERT_EQ(signals.size(), 3U);
  EXPECT_EQ(signals[1].at("modbus").at("count").as_int64(), 2);
  EXPECT_EQ(signals[2].at("type").as_string(), "bool");
  EXPECT_EQ(signals[2].at("modbus").at("kind").as_string(), "bit");
  EXPECT_TRUE(signals[0].at("mqtt").at("topic").is_null()) << "single topics are switched off";
}

TEST(MapAsTable, AlignsItsColumnsAndTellsWhatIsOff) {
  EXPECT_EQ(
      render_map(line3("[drive.signals.output_frequency]\nunit = \"°C\"\n"), MapFormat::table),
      "drive  signal            object     type  scale  unit  access  source  min  max  modbus         topic       "
      "                          set  note\n"
      "pump1  output_frequency  0x2021:02  u16   0.01   °C    read    tpdo1             5: register 2  "
      "canopen/line3/pump1/output_frequency\n"
      "bus can0  no bitrate stated\n"
      "Modbus is off: there is no [modbus] in the configuration; these would be the registers and bits.\n"
      "MQTT is off: there is no [mqtt] in the configuration; these would be the topics.\n");
}

TEST(MapAsTable, SaysNothingOfWhatIsOn) {
  EXPECT_THAT(render_map(line3("[modbus]\n[mqtt]\n"), MapFormat::table), Not(HasSubstr(" off")));
  EXPECT_THAT(render_map(line3("[modbus]\n"), MapFormat::table),
              AllOf(Not(HasSubstr("Modbus is off")), HasSubstr("MQTT is off")));
}

/// A bus of 10 kbit/s with the gateway's heartbeat ten times a second and nothing else: ten frames of one byte, which
/// have 55 bits, and 65 with all stuff bits they can have.
config::Model slow_bus() {
  config::Model model;
  model.gateway.name = "line3";
  model.buses.push_back({.name = "can0", .interface = "can0", .bitrate = 10'000, .heartbeat = milliseconds(100)});
  return model;
}

TEST(MapBuses, HaveTheirForecastInPercentWithOneDecimal) {
  const auto buses = boost::json::parse(render_map(slow_bus(), MapFormat::json)).at("buses").as_array();
  ASSERT_EQ(buses.size(), 1U);
  const boost::json::object& bus = buses[0].as_object();
  EXPECT_EQ(bus.at("bitrate").as_int64(), 10'000);
  EXPECT_EQ(bus.at("load_worst").as_double(), 6.5);
  EXPECT_GE(bus.at("load").as_double(), 5.5);
  EXPECT_LT(bus.at("load").as_double(), 6.5);
  EXPECT_FALSE(bus.at("at_least").as_bool());
  EXPECT_THAT(render_map(slow_bus(), MapFormat::table),
              ContainsRegex("\nbus can0  10000 bit/s  load [56]\\.[0-9] %  worst 6\\.5 %\n"));
}

TEST(MapBuses, AreMarkedWhereTheirLoadIsTheLeastThatCanBe) {
  config::Model model = slow_bus();
  config::Drive& drive = model.drives.emplace_back();
  canopen::PdoSettings& on_change = drive.node.tpdos.emplace_back();
  on_change.transmission_type = 254;
  on_change.mapping.push_back({.object = {0x2021, 2}, .bits = 16});
  const auto root = boost::json::parse(render_map(model, MapFormat::json));
  EXPECT_TRUE(root.at("buses").at(0).at("at_least").as_bool());
  EXPECT_THAT(render_map(model, MapFormat::table),
              ContainsRegex("load at least [0-9]+\\.[0-9] %  worst at least [0-9]+\\.[0-9] %\n"));
}

TEST(MapNotes, MarkWhatIsUnconfirmed) {
  const config::Model model = line3("[drive.signals.output_frequency]\nunconfirmed = true\n");
  EXPECT_THAT(render_map(model, MapFormat::table), HasSubstr("pump1/output_frequency       unconfirmed\n"));
  EXPECT_THAT(render_map(model, MapFormat::csv), HasSubstr("pump1/output_frequency,,unconfirmed\n"));
  EXPECT_THAT(render_map(model, MapFormat::markdown), HasSubstr("pump1/output_frequency |  | unconfirmed |\n"));
  EXPECT_THAT(render_map(model, MapFormat::json), HasSubstr("\"unconfirmed\": true}"));
}

TEST(MapAsCsv, QuotesWhatHasACommaOrAQuote) {
  EXPECT_EQ(render_map(line3("[drive.signals.output_frequency]\nunit = \"a,\\\"b\"\n"), MapFormat::csv),
            "drive,signal,object,type,scale,unit,access,source,min,max,modbus,topic,set,note\n"
            "pump1,output_frequency,0x2021:02,u16,0.01,\"a,\"\"b\",read,tpdo1,,,5: register "
            "2,canopen/line3/pump1/output_frequency,,\n");
}

TEST(MapAsMarkdown, EscapesBars) {
  const std::string text = render_map(line3("[drive.signals.output_frequency]\nunit = \"a|b\"\n"), MapFormat::markdown);
  EXPECT_THAT(text, HasSubstr("| a\\|b |"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
}

TEST(MapFormats, AreKnownByName) {
  EXPECT_EQ(parse_map_format("table"), MapFormat::table);
  EXPECT_EQ(parse_map_format("json"), MapFormat::json);
  EXPECT_EQ(parse_map_format("csv"), MapFormat::csv);
  EXPECT_EQ(parse_map_format("markdown"), MapFormat::markdown);
  EXPECT_EQ(parse_map_format("xml"), std::nullopt);
}

}  // namespace
}  // namespace gateway
