#include "daemon/control/plant_service.h"

#include <gmock/gmock.h>

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <regex>
#include <string>
#include <vector>

#include "daemon/control/status_table.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/demo_model.h"
#include "tests/unit/daemon/demo_plant.h"

namespace gateway::control {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// The demo's drives; the first two take commands of the command line.
config::Model commanded_model() {
  config::Model model = gateway::test::demo_model();
  model.modbus.reset();
  model.mqtt.reset();
  model.gateway.control.clear();
  for (config::Drive& drive : model.drives) {
    drive.commands.writers = {.modbus = true, .mqtt = true, .local = drive.name == "fan1" || drive.name == "pump1"};
    drive.commands.lease = drive.name == "fan1" ? 10s : 0s;
  }
  return model;
}

class ControlPlant : public gateway::test::DemoPlant {
 protected:
  ControlPlant() : DemoPlant(commanded_model()) { begin_plant(); }
  ~ControlPlant() override { end_plant(); }

  // The answer, but for the name of the command, which is in command_.
  std::string ask(const std::string& text) {
    Line line = parse_line(text);
    if (line.request.has_error()) {
      ADD_FAILURE() << to_string(line.request.error());
      return "";
    }
    const auto answer = support::spawn(loop_.executor(), service_.answer({.request = std::move(line.request.value()),
                                                                          .id = line.id,
                                                                          .user = "anna",
                                                                          .received = canopen::Clock::now()}));
    EXPECT_TRUE(loop_.advance_until([&] { return answer.done(); }, 5s)) << text;
    std::string told = answer.done() ? answer.get() : "";
    command_.clear();
    if (std::smatch found; std::regex_search(told, found, std::regex(R"re(,"command":"([^"]*)")re"))) {
      command_ = found[1];
      told.erase(static_cast<std::size_t>(found.position()), static_cast<std::size_t>(found.length()));
    }
    return told;
  }
  boost::json::object status() {
    return boost::json::parse(ask(R"({"op":"status"})")).as_object().at("status").as_object();
  }
  static boost::json::object drive_of(const boost::json::object& status, std::string_view name) {
    for (const boost::json::value& drive : status.at("drives").as_array()) {
      if (drive.as_object().at("name").as_string() == boost::json::string_view(name.data(), name.size())) {
        return drive.as_object();
      }
    }
    return {};
  }
  bool is_stop(const std::string& text) { return service_.is_stop(parse_line(text).request.value()); }

  Service service_ = plant_service(gateway_.plant());
  std::string command_;
};

const std::string kRun =
    R"({"id":1,"op":"set","drive":"pump1","values":{"frequency_command":30.0,"torque_command":0,"control_command":"forward"}})";

TEST_F(ControlPlant, SetRunsADrive) {
  EXPECT_TRUE(drive_of(status(), "pump1").at("commanded").as_object().empty());
  EXPECT_EQ(ask(kRun), R"({"id":1,"ok":true})");
  loop_.advance(15s, 5ms);
  const boost::json::object pump = drive_of(status(), "pump1");
  EXPECT_EQ(pump.at("commanded").at("frequency_command").to_number<double>(), 30.0);
  EXPECT_EQ(pump.at("commanded").at("control_command").as_string(), "forward");
  EXPECT_EQ(pump.at("values").at("output_frequency").to_number<double>(), 30.0);
  EXPECT_EQ(pump.at("values").at("running").as_bool(), true);
}

TEST_F(ControlPlant, RecordsWhatIsAskedFor) {
  EXPECT_THAT(ask(R"({"id":1,"op":"record","drive":"pump1"})"),
              AllOf(HasSubstr("\"code\":\"unknown\""), HasSubstr("has no [recorder]")));
  std::string asked;
  service_ =
      plant_service(gateway_.plant(), {}, [&](std::size_t bus, const std::string& drive, const std::string& user) {
        asked = std::to_string(bus) + '|' + drive + '|' + user;
        return recorder::Recorder::Requested{.name = "x.log", .was_under_way = true, .remaining = 1500ms};
      });
  EXPECT_EQ(ask(R"({"id":1,"op":"record","drive":"pump1"})"),
            R"({"id":1,"ok":true,"record":"x.log","under_way":true,"remaining_ms":1500})");
  EXPECT_EQ(asked, "0|pump1|anna");
  ask(R"({"id":1,"op":"record","bus":"demo"})");
  EXPECT_EQ(asked, "0||anna");
  asked.clear();
  EXPECT_THAT(ask(R"({"id":1,"op":"record","drive":"pump9"})"), HasSubstr("no drive \\\"pump9\\\""));
  EXPECT_THAT(ask(R"({"id":1,"op":"record","bus":"can9"})"), HasSubstr("no bus \\\"can9\\\""));
  EXPECT_EQ(asked, "");
}

TEST_F(ControlPlant, TellsWhatTheDriveHoldsAlready) {
  const std::string slow = R"({"id":1,"op":"set","drive":"pump1","values":{"frequency_command":20.0}})";
  EXPECT_EQ(ask(slow), R"({"id":1,"ok":true})");
  EXPECT_EQ(ask(slow), R"({"id":1,"ok":true,"unchanged":true})");
}

TEST_F(ControlPlant, NamesEachCommandAsTheJournalDoes) {
  EXPECT_EQ(ask(kRun), R"({"id":1,"ok":true})");
  const std::string first = command_;
  EXPECT_THAT(ask(R"({"id":1,"op":"set","drive":"pump1","values":{"frequency_command":90}})"), HasSubstr("\"range\""));
  EXPECT_NE(first, "");
  EXPECT_NE(command_, "");
  EXPECT_NE(command_, first);
  ask(R"({"op":"status"})");
  EXPECT_EQ(command_, "");
}

TEST_F(ControlPlant, RefusesAsOverMqtt) {
  const std::string set = R"({"id":1,"op":"set","drive":"pump1","values":)";
  EXPECT_THAT(ask(set + R"({"frequency_command":50.01}})"),
              AllOf(HasSubstr("{\"id\":1,\"ok\":false,\"code\":\"range\""), HasSubstr("\"error\":\"")));
  EXPECT_THAT(ask(set + R"({"frequency_command":"fast"}})"), HasSubstr("\"code\":\"type\""));
  EXPECT_THAT(ask(set + R"({"output_frequency":1}})"), HasSubstr("\"code\":\"read-only\""));
  EXPECT_THAT(ask(set + R"({"frequenzy":1}})"), HasSubstr("\"code\":\"unknown\""));
  EXPECT_THAT(ask(set + "{}}"), HasSubstr("\"code\":\"type\""));
  EXPECT_THAT(ask(R"({"id":1,"op":"set","drive":"pump9","values":{"a":1}})"),
              AllOf(HasSubstr("\"code\":\"unknown\""), HasSubstr("no drive \\\"pump9\\\"")));
  EXPECT_THAT(ask(R"({"id":1,"op":"nmt","drive":"pump1","command":"go"})"), HasSubstr("\"code\":\"unknown\""));
}

TEST_F(ControlPlant, WhoMayNotCommandIsToldThatFirst) {
  for (const std::string& request :
       {std::string(R"({"op":"set","drive":"hoist1","values":{"frequency_command":10}})"),
        std::string(R"({"op":"set","drive":"hoist1","values":{"no_such_signal":10}})"),
        std::string(R"({"op":"nmt","drive":"hoist1","command":"stop"})"),
        std::string(R"({"op":"nmt","drive":"hoist1","command":"go"})"),
        std::string(R"({"op":"sdo-write","drive":"hoist1","object":"0x2100:03","type":"u16","value":1})"),
        std::string(R"({"op":"sdo-write","drive":"hoist1","object":"junk","value":1})")}) {
    EXPECT_THAT(ask(request), HasSubstr("\"code\":\"forbidden\"")) << request;
  }
}

TEST_F(ControlPlant, ReadsObjectsOfAnyDrive) {
  EXPECT_EQ(ask(R"({"id":1,"op":"sdo-read","drive":"hoist1","object":"0x1018:01","type":"u32"})")
                .find(R"({"id":1,"ok":true,"value":)"),
            0U);
  const config::Signal& signal = model_.drives[1].signals[model_.drives[1].find("output_frequency").value()];
  EXPECT_EQ(ask(R"({"id":1,"op":"sdo-read","drive":"pump1","object":")" + to_string(signal.object) + "\"}"),
            R"({"id":1,"ok":true,"value":0})")
      << "its signal has the type";
  EXPECT_THAT(ask(R"({"op":"sdo-read","drive":"pump1","object":"0x1018:01"})"),
              AllOf(HasSubstr("\"code\":\"type\""), HasSubstr("no signal of pump1 has the object 0x1018:01")));
  EXPECT_THAT(ask(R"({"op":"sdo-read","drive":"pump1","object":"frequency"})"), HasSubstr("\\\"object\\\" is to be"));
  EXPECT_THAT(ask(R"({"op":"sdo-read","drive":"pump1","object":"0x1018:77","type":"u32"})"),
              AllOf(HasSubstr("\"code\":\"refused\""), HasSubstr("\"abort\":\"0x06020000")));
}

TEST_F(ControlPlant, ReadsAndWritesBytes) {
  EXPECT_EQ(ask(R"({"id":1,"op":"sdo-read","drive":"pump1","object":"0x1017:00","type":"bytes"})"),
            R"({"id":1,"ok":true,"value":"F401"})");
  EXPECT_EQ(ask(R"({"id":1,"op":"sdo-read","drive":"pump1","object":"0x5FFF:00","type":"string"})")
                .find(R"({"id":1,"ok":false,"code":"refused")"),
            0U);
  EXPECT_THAT(ask(R"({"op":"sdo-write","drive":"fan1","object":"0xBF00:00","type":"bytes","value":"0500"})"),
              HasSubstr("\"code\":\"forbidden\""));
  EXPECT_THAT(ask(R"({"op":"sdo-write","drive":"pump1","object":"0xBF00:00","type":"bytes","value":"5"})"),
              HasSubstr("\"code\":\"type\""));
  EXPECT_EQ(ask(R"({"id":1,"op":"sdo-write","drive":"pump1","object":"0xBF00:00","type":"bytes","value":"0500"})"),
            R"({"id":1,"ok":true})");
}

TEST_F(ControlPlant, WritesObjectsWhereRawIsGranted) {
  const std::string trip = R"(","object":"0xBF00:00","type":"u16","value":5})";
  EXPECT_THAT(ask(R"({"op":"sdo-write","drive":"fan1)" + trip), HasSubstr("\"code\":\"forbidden\""));
  EXPECT_EQ(ask(R"({"id":1,"op":"sdo-write","drive":"pump1)" + trip), R"({"id":1,"ok":true})");
  loop_.advance(1s);
  const boost::json::object pump = drive_of(status(), "pump1");
  ASSERT_EQ(pump.at("alarms").as_array().size(), 1U);
  EXPECT_EQ(pump.at("alarms").as_array().front().at("kind").as_string(), "emcy");
  EXPECT_EQ(pump.at("alarms").as_array().front().at("code").as_string(), "0x0005");
}

TEST_F(ControlPlant, CommandsTheStateOfANode) {
  EXPECT_EQ(ask(R"({"id":1,"op":"nmt","drive":"pump1","command":"pre-operational"})"), R"({"id":1,"ok":true})");
  loop_.advance(1s);
  EXPECT_EQ(drive_of(status(), "pump1").at("nmt").as_string(), "pre-operational");
}

TEST_F(ControlPlant, StopsEveryDriveThatTakesItsCommands) {
  EXPECT_EQ(ask(kRun), R"({"id":1,"ok":true})");
  loop_.advance(2s, 5ms);
  ASSERT_TRUE(drive_of(status(), "pump1").at("values").at("running").as_bool());
  EXPECT_EQ(ask(R"({"id":"x","op":"stop"})"), R"({"id":"x","ok":true,"stopped":2})");
  loop_.advance(20s, 5ms);
  EXPECT_FALSE(drive_of(status(), "pump1").at("values").at("running").as_bool());
}

TEST_F(ControlPlant, AStopIsCarriedOutWhateverIsWrongBesideIt) {
  EXPECT_EQ(ask(kRun), R"({"id":1,"ok":true})");
  loop_.advance(2s, 5ms);
  EXPECT_THAT(ask(R"({"id":1,"op":"set","drive":"pump1","values":{"speed":0,"control_command":"stop"}})"),
              AllOf(HasSubstr("\"code\":\"unknown\""), HasSubstr("no signal \\\"speed\\\""),
                    HasSubstr("nothing but the stop was sent, and it was confirmed")));
  loop_.advance(20s, 5ms);
  EXPECT_FALSE(drive_of(status(), "pump1").at("values").at("running").as_bool());
}

TEST_F(ControlPlant, AStopNamesThoseThatDoNotConfirm) {
  drives_.front()->power_off();
  loop_.advance(5s, 5ms);
  EXPECT_THAT(ask(R"({"id":"x","op":"stop"})"),
              AllOf(HasSubstr("\"ok\":false"), HasSubstr("not confirmed by all: fan1: "), Not(HasSubstr("pump1"))));
}

TEST_F(ControlPlant, KnowsWhichRequestsAreStops) {
  const std::string set = R"({"op":"set","drive":"pump1","values":)";
  EXPECT_TRUE(is_stop(R"({"op":"stop"})"));
  EXPECT_TRUE(is_stop(set + R"({"control_command":"stop"}})"));
  EXPECT_TRUE(is_stop(set + R"({"frequency_command":0,"control_command":6}})"));
  EXPECT_FALSE(is_stop(set + R"({"control_command":"forward"}})"));
  EXPECT_FALSE(is_stop(set + R"({"frequency_command":0}})"));
  EXPECT_TRUE(is_stop(set + R"({"x":1,"control_command":"stop"}})")) << "whatever stands beside it";
  EXPECT_FALSE(is_stop(R"({"op":"set","drive":"pump9","values":{"control_command":5}})"));
  EXPECT_FALSE(is_stop(R"({"op":"status"})"));
}

TEST_F(ControlPlant, TellsHowThingsStand) {
  const boost::json::object told = status();
  EXPECT_EQ(told.at("gateway").as_string(), "demo");
  EXPECT_GT(told.at("uptime").to_number<double>(), 1.0);
  ASSERT_EQ(told.at("buses").as_array().size(), 1U);
  const boost::json::object& bus = told.at("buses").as_array().front().as_object();
  EXPECT_EQ(bus.at("state").as_string(), "error-active");
  EXPECT_TRUE(bus.at("up").as_bool());
  ASSERT_EQ(told.at("drives").as_array().size(), 4U);
  const boost::json::object pump = drive_of(told, "pump1");
  EXPECT_EQ(pump.at("node").to_number<int>(), 5);
  EXPECT_TRUE(pump.at("online").as_bool());
  EXPECT_EQ(pump.at("nmt").as_string(), "operational");
  EXPECT_EQ(pump.at("boot").as_string(), "ok");
  EXPECT_LT(pump.at("heartbeat_age").to_number<double>(), 1.0);
  EXPECT_TRUE(pump.at("fresh").as_bool());
  EXPECT_TRUE(pump.at("alarms").as_array().empty());
  EXPECT_TRUE(pump.at("control").at("holder").is_null());
  EXPECT_FALSE(pump.at("control").at("timeout").as_bool());
}

TEST_F(ControlPlant, TellsWhoHoldsADrive) {
  EXPECT_EQ(ask(R"({"id":1,"op":"set","drive":"fan1","values":{"frequency_command":20.0}})"), R"({"id":1,"ok":true})");
  EXPECT_EQ(drive_of(status(), "fan1").at("control").at("holder").as_string(), "local anna");
}

TEST_F(ControlPlant, TellsWhatIsGone) {
  drives_[1]->power_off();
  loop_.advance(5s, 5ms);
  const boost::json::object pump = drive_of(status(), "pump1");
  EXPECT_FALSE(pump.at("online").as_bool());
  EXPECT_FALSE(pump.at("fresh").as_bool());
  EXPECT_TRUE(pump.at("values").at("output_frequency").is_null());
  EXPECT_EQ(pump.at("alarms").as_array().front().at("kind").as_string(), "heartbeat");
  wire_.set_state({canopen::BusCondition::down, 0, 0});
  loop_.advance(100ms);
  EXPECT_EQ(status().at("buses").as_array().front().at("state").as_string(), "down");
}

}  // namespace
}  // namespace gateway::control
