// What Home Assistant is told of a drive. The messages of the four systems are judged by
// tests/system/home_assistant.sh.

#include <gtest/gtest.h>

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <string>
#include <vector>

#include "bridges/mqtt/home_assistant/device.h"
#include "bridges/mqtt/home_assistant/prefixes.h"
#include "tests/unit/mqtt/site.h"

namespace mqtt::home_assistant {
namespace {

using namespace std::chrono_literals;
namespace json = boost::json;
using config::Access;

class HomeAssistantDeviceTest : public testing::Test {
 protected:
  config::Drive& drive() { return model_.drives[0]; }
  config::Signal& signal(test::SignalPosition position) { return drive().signals[position]; }
  Device device(const Entities& before = {}) {
    const Topics topics(model_, settings_, "line3");
    return device_of(drive(), topics, 0, settings_, "1.2.3", before);
  }
  json::object components() { return json::parse(device().message).at("components").as_object(); }
  /// As it stands in the message; empty: it is not there.
  std::string entity(const std::string& key) {
    const json::object all = components();
    const json::value* const found = all.if_contains(key);
    return found == nullptr ? std::string() : json::serialize(*found);
  }
  static std::string field(const std::string& object, const char* name) {
    const json::value read = json::parse(object);
    const json::value* const found = read.as_object().if_contains(name);
    return found == nullptr ? std::string() : json::serialize(*found);
  }

  config::Model model_ = test::model();
  config::Mqtt settings_;
};

TEST_F(HomeAssistantDeviceTest, ADriveIsADeviceThatIsThereWhileBothAreOnline) {
  const std::string message = device().message;
  EXPECT_EQ(message.find(R"({"device":{"identifiers":["canopen/line3/pump1"],"name":"line3 pump1","model":"test"},)"
                         R"("origin":{"name":"canopen-gateway","sw_version":"1.2.3"},)"
                         R"("availability":[{"topic":"canopen/line3/status"},{"topic":"canopen/line3/pump1/status"}],)"
                         R"("availability_mode":"all","state_topic":"canopen/line3/pump1/state","components":{)"),
            0U)
      << message;
}

TEST_F(HomeAssistantDeviceTest, ANumberWithAUnitIsAMeasurement) {
  EXPECT_NE(device().message.find(
                R"("sensor_output_frequency":{"platform":"sensor",)"
                R"("unique_id":"canopen/line3/pump1/sensor_output_frequency","name":"Output frequency",)"
                R"("value_template":"{{ value_json['values']['output_frequency'] }}","unit_of_measurement":"Hz",)"
                R"("device_class":"frequency","state_class":"measurement","suggested_display_precision":2,)"
                R"("expire_after":180})"),
            std::string::npos)
      << device().message;
}

TEST_F(HomeAssistantDeviceTest, AClassGoesOnlyWithAUnitThatMeansNothingElse) {
  struct Case {
    const char* unit;
    const char* device_class;
    const char* state_class;
  };
  for (const Case& each :
       {Case{"A", "\"current\"", "\"measurement\""}, Case{"V", "\"voltage\"", "\"measurement\""},
        Case{"kW", "\"power\"", "\"measurement\""}, Case{"°C", "\"temperature\"", "\"measurement\""},
        Case{"rpm", "", "\"measurement\""}, Case{"Nm", "", "\"measurement\""}, Case{"%", "", "\"measurement\""},
        Case{"K", "", "\"measurement\""}, Case{"kWh", "\"energy\"", ""}}) {
    signal(test::kFrequency).unit = each.unit;
    const std::string shown = entity("sensor_output_frequency");
    EXPECT_EQ(field(shown, "unit_of_measurement"), '"' + std::string(each.unit) + '"');
    EXPECT_EQ(field(shown, "device_class"), each.device_class) << each.unit;
    EXPECT_EQ(field(shown, "state_class"), each.state_class) << each.unit;
  }
}

TEST_F(HomeAssistantDeviceTest, ANumberWithoutAUnitMayBeACodeAndIsNoMeasurement) {
  for (const char* key : {"sensor_status_word", "sensor_fault_code"}) {
    const std::string shown = entity(key);
    EXPECT_EQ(field(shown, "entity_category"), R"("diagnostic")") << key;
    EXPECT_EQ(field(shown, "state_class") + field(shown, "suggested_display_precision"), "") << shown;
  }
}

TEST_F(HomeAssistantDeviceTest, ANameIsOneOfItsOptionsAndAnUnknownCodeIsUnknown) {
  signal(test::kState).values = {{3, "it's {{ off }}"}, {-4, "\"on\""}};
  const std::string shown = entity("sensor_drive_state");
  EXPECT_EQ(field(shown, "options"), R"(["\"on\"","it's {{ off }}"])");
  EXPECT_EQ(field(shown, "device_class"), R"("enum")");
  EXPECT_EQ(
      field(shown, "value_template"),
      R"("{{ value_json['values']['drive_state'] if value_json['values']['drive_state_code'] in [-4, 3] else None }}")");
}

TEST_F(HomeAssistantDeviceTest, ABooleanIsOnOrOffAndMeansSomethingWhereTheProfileSaysSo) {
  const std::string running = entity("binary_sensor_running");
  EXPECT_EQ(field(running, "device_class"), R"("running")");
  EXPECT_EQ(field(running, "payload_on") + field(running, "payload_off"), R"("True""False")");
  EXPECT_EQ(field(entity("binary_sensor_brake"), "device_class"), "");
  drive().faults.running.reset();
  drive().faults.fault = test::kRunning;
  EXPECT_EQ(field(entity("binary_sensor_running"), "device_class"), R"("problem")");
}

TEST_F(HomeAssistantDeviceTest, AValueEndsWithWhatTheGatewayPublishesNoMore) {
  settings_.expiry = 4500ms;
  EXPECT_EQ(field(entity("sensor_output_frequency"), "expire_after"), "5");
  EXPECT_EQ(field(entity("binary_sensor_running"), "expire_after"), "5");
  EXPECT_EQ(field(entity("sensor_nmt"), "expire_after"), "5");
  settings_.expiry = 0s;
  settings_.max_interval = 100s;
  EXPECT_EQ(field(entity("sensor_output_frequency"), "expire_after"), "300") << "nothing lives for ever there";
}

TEST_F(HomeAssistantDeviceTest, NobodyCommandsWhereMqttMayNot) {
  drive().node.motor.stops = {{.mask = 0xFFFF, .equals = 6}};
  drive().commands.writers = {.modbus = true, .local = true};
  for (const auto& [key, platform] : device().entities) {
    EXPECT_TRUE(platform == "sensor" || platform == "binary_sensor") << key;
  }
  EXPECT_EQ(device().message.find("command_topic"), std::string::npos);
}

TEST_F(HomeAssistantDeviceTest, ASetPointIsABoxWithItsLimitsThatNeverShowsWhatWasOnlyAskedFor) {
  signal(test::kFrequencyCommand).unit = "Hz";
  EXPECT_EQ(entity("number_frequency_command"),
            R"({"platform":"number","unique_id":"canopen/line3/pump1/number_frequency_command",)"
            R"("name":"Frequency command","value_template":"{{ None }}",)"
            R"("command_topic":"canopen/line3/pump1/frequency_command/set","qos":0,"retain":false,)"
            R"("min":0,"max":50,"step":1E-2,"mode":"box","unit_of_measurement":"Hz","device_class":"frequency"})");
  signal(test::kFrequencyCommand).access = Access::read_write;
  EXPECT_EQ(
      field(entity("number_frequency_command"), "value_template"),
      R"("{{ value_json['values']['frequency_command'] if value_json['values']['frequency_command'] is number and )"
      R"(0 <= value_json['values']['frequency_command'] <= 50 else None }}")");
}

TEST_F(HomeAssistantDeviceTest, WithoutLimitsOfItsOwnASetPointHasThoseOfItsType) {
  config::Signal& command = signal(test::kFrequencyCommand);
  const auto limits = [&] {
    const std::string shown = entity("number_frequency_command");
    return shown.empty() ? shown : field(shown, "min") + " " + field(shown, "max");
  };
  command.unit = "Hz";
  command.min.reset();
  command.max.reset();
  EXPECT_EQ(limits(), "0 6.5535E2");
  command.type = canopen::DataType::i16;
  EXPECT_EQ(limits(), "-3.2768E2 3.2767E2");
  command.scale = 0.1;
  command.decimals = 1;
  EXPECT_EQ(limits(), "-3.2768E3 3.2767E3") << "and not 3276.7000000000003";
  command.decimals = 2;
  command.scale = -0.01;
  EXPECT_EQ(limits(), "-3.2767E2 3.2768E2");
  EXPECT_EQ(field(entity("number_frequency_command"), "step"), "1E-2");
  command.type = canopen::DataType::f32;
  EXPECT_EQ(limits(), "") << "a type that says nothing of what is sensible";
  command.min = 1.0;
  command.max = 2.0;
  EXPECT_EQ(limits(), "1 2");
  command.min = 2.0;
  EXPECT_EQ(limits(), "") << "nothing to choose from";
}

TEST_F(HomeAssistantDeviceTest, AWordIsNoSetPoint) {
  signal(test::kControlCommand).min = 0.0;
  signal(test::kControlCommand).max = 255.0;
  signal(test::kCounter).unit = "";
  EXPECT_EQ(entity("number_control_command"), "") << "any word may start the motor";
  EXPECT_EQ(entity("number_energy"), "");
  signal(test::kFrequencyCommand).momentary = {1};
  EXPECT_EQ(entity("number_frequency_command"), "");
}

TEST_F(HomeAssistantDeviceTest, OfAWordWithoutNamesThereIsAStopAndNothingElse) {
  EXPECT_EQ(entity("button_stop"), "") << "no stop is known";
  drive().node.motor.stops = {{.mask = 0x80, .equals = 0}, {.mask = 0xFFFF, .equals = 6}};
  EXPECT_EQ(entity("button_stop"),
            R"({"platform":"button","unique_id":"canopen/line3/pump1/button_stop","name":"Stop",)"
            R"("command_topic":"canopen/line3/pump1/control_command/set","qos":1,"retain":false,)"
            R"("payload_press":"{\"value\":6}"})");
  EXPECT_EQ(entity("select_control_command"), "");
}

TEST_F(HomeAssistantDeviceTest, NamedCommandsAreAChoiceAndMomentaryOnesButtonsThatWaitToBeEnabled) {
  config::Signal& control = signal(test::kControlCommand);
  control.values = {{1, "forward"}, {5, "st\"op"}, {7, "fault-reset"}};
  control.momentary = {7};
  drive().node.motor.stops = {{.mask = 0xFFFF, .equals = 5}};
  const std::string select = entity("select_control_command");
  EXPECT_EQ(field(select, "options"), R"(["forward","st\"op"])");
  EXPECT_EQ(field(select, "value_template"), R"("{{ None }}")");
  EXPECT_EQ(field(select, "command_template"), R"("{{ {'value': value} | tojson }}")");
  EXPECT_EQ(field(select, "enabled_by_default"), "false") << "one touch of it starts the motor";
  EXPECT_EQ(field(entity("select_mode"), "enabled_by_default"), "");
  const std::string reset = entity("button_control_command_7");
  EXPECT_EQ(field(reset, "name"), R"("Control command: fault-reset")");
  EXPECT_EQ(field(reset, "payload_press"), R"("{\"value\":\"fault-reset\"}")");
  EXPECT_EQ(field(reset, "enabled_by_default"), "false");
  const std::string stop = entity("button_stop");
  EXPECT_EQ(field(stop, "payload_press"), R"("{\"value\":\"st\\\"op\"}")");
  EXPECT_EQ(field(stop, "enabled_by_default"), "");
}

TEST_F(HomeAssistantDeviceTest, WhatCanBeReadIsShownWhereItIsChosen) {
  EXPECT_EQ(field(entity("select_mode"), "value_template"),
            R"("{{ value_json['values']['mode'] if value_json['values']['mode_code'] in [0, 1] else None }}")");
  EXPECT_EQ(field(entity("select_brake"), "options"), R"(["false","true"])");
  EXPECT_EQ(field(entity("select_brake"), "value_template"), R"("{{ value_json['values']['brake'] | lower }}")");
  EXPECT_EQ(field(entity("select_brake"), "command_template"), R"("{{ {'value': value == 'true'} | tojson }}")");
  EXPECT_NE(entity("sensor_mode"), "") << "and it ends there, which a choice does not";
}

TEST_F(HomeAssistantDeviceTest, WhatIsGoneIsNamedWithItsPlatformAlone) {
  const Device made = device({{"sensor_nmt", "sensor"}, {"sensor_old", "sensor"}});
  EXPECT_NE(made.message.find(R"("sensor_old":{"platform":"sensor"}})"), std::string::npos) << made.message;
  EXPECT_FALSE(made.entities.contains("sensor_old"));
  EXPECT_EQ(read_kept_device(made.message, "canopen/line3/status"), made.entities) << "that is no entity of it";
}

TEST_F(HomeAssistantDeviceTest, AKeptMessageIsReadBackAndThatOfAnotherGatewayIsNot) {
  const Device made = device();
  EXPECT_EQ(read_kept_device(made.message, "canopen/line3/status"), made.entities);
  EXPECT_GT(made.entities.size(), 5U);
  EXPECT_FALSE(read_kept_device(made.message, "canopen/line4/status"));
  for (const char* other :
       {"", "{", "[]", "1", R"({"availability":[]})", R"({"availability":{"topic":"canopen/line3/status"}})",
        R"({"availability":["canopen/line3/status"]})", R"({"availability":[{"topic":5}]})"}) {
    EXPECT_FALSE(read_kept_device(other, "canopen/line3/status")) << other;
  }
  const std::string ours = R"({"availability":[{"topic":"canopen/line3/status"}])";
  EXPECT_EQ(read_kept_device(ours + "}", "canopen/line3/status"), Entities{});
  EXPECT_EQ(read_kept_device(
                ours + R"(,"components":{"a b":{"platform":"sensor","x":1},"a\"b":{"platform":"sensor","x":1},)" +
                    R"("a":{"platform":"s\"","x":1},"b":{"platform":"sensor"},"c":5,"d":{"x":1,"y":2},)" +
                    R"("foo_x":{"platform":"foo","x":1},"sensor_x":{"platform":"number","x":1},)" +
                    R"("sensor":{"platform":"sensor","x":1},"x":{"platform":"","x":1}}})",
                "canopen/line3/status"),
            Entities{})
      << "nothing of it is one of ours";
}

TEST_F(HomeAssistantDeviceTest, ThePrefixesOfBeforeAreReadWhateverStandsThere) {
  EXPECT_EQ(read_kept_prefixes(R"({"prefixes":["homeassistant",5,"a/b"]})"),
            (std::vector<std::string>{"homeassistant", "a/b"}));
  for (const char* other : {"", "{", "[]", R"({"prefixes":null})", R"({"prefixes":"x"})", R"({"x":1})"}) {
    EXPECT_TRUE(read_kept_prefixes(other).empty()) << other;
  }
}

}  // namespace
}  // namespace mqtt::home_assistant
