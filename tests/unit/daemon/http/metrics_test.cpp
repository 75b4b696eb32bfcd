#include "daemon/http/metrics.h"

#include <gmock/gmock.h>

#include <set>
#include <sstream>
#include <string>

#include "tests/unit/daemon/http/shown_plant.h"

namespace gateway::http {
namespace {

using namespace std::chrono_literals;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class HttpMetrics : public test::ShownPlant {};

TEST_F(HttpMetrics, TellOfBusesAndDrives) {
  const std::string told = text("/metrics");
  EXPECT_EQ(get("/metrics").type, "text/plain; version=0.0.4; charset=utf-8");
  for (const char* const line :
       {"canopen_gateway_info{gateway=\"demo\",version=\"1.2.3\"", "canopen_gateway_healthy 1\n",
        "canopen_gateway_bus_up{bus=\"demo\"} 1\n", "canopen_gateway_bus_state{bus=\"demo\",state=\"active\"} 1\n",
        "canopen_gateway_bus_state{bus=\"demo\",state=\"bus-off\"} 0\n",
        "canopen_gateway_drive_info{drive=\"pump1\",bus=\"demo\",node=\"5\",profile=\"veichi-ac310\"} 1\n",
        "canopen_gateway_drive_online{drive=\"pump1\"} 1\n", "canopen_gateway_drive_values_fresh{drive=\"fan1\"} 1\n",
        "canopen_gateway_drive_boot_result{drive=\"mixer1\",result=\"ok\"} 1\n",
        "canopen_gateway_drive_boot_ups_total{drive=\"hoist1\"} 1\n",
        "canopen_gateway_alarms_active{kind=\"heartbeat\",severity=\"fault\"} 0\n",
        "# TYPE canopen_gateway_bus_frames_received_total counter\n"}) {
    EXPECT_THAT(told, HasSubstr(line));
  }
  const auto counted = gateway_.plant().bus_statistics(0);
  EXPECT_THAT(told, HasSubstr("canopen_gateway_bus_frames_received_total{bus=\"demo\"} " +
                              std::to_string(counted.frames_received) + "\n"));
  EXPECT_THAT(told, ContainsRegex("canopen_gateway_drive_heartbeat_age_seconds.drive=\"pump1\". 0[.0-9]*\n"));
  EXPECT_THAT(told, Not(HasSubstr("modbus"))) << "it is off";
  EXPECT_THAT(told, Not(HasSubstr("mqtt")));
}

TEST(HttpErrorShare, IsOfTheFramesThatThereWere) {
  EXPECT_EQ(error_share({}), 0.0);
  EXPECT_EQ(error_share({.frames_received = 4, .frames_sent = 1, .error_frames = 5}), 0.5);
  EXPECT_EQ(error_share({.error_frames = 3}), 1.0);
  EXPECT_EQ(error_share({.frames_received = 800'000, .frames_sent = 200'000, .error_frames = 5}), 0.0005)
      << "of the newest 10 000";
}

TEST_F(HttpMetrics, TellOfAlarms) {
  drives_[1]->power_off();
  loop_.advance(5s);
  const std::string told = text("/metrics");
  EXPECT_THAT(told, HasSubstr("canopen_gateway_alarms_active{kind=\"heartbeat\",severity=\"fault\"} 1\n"));
  EXPECT_THAT(told, HasSubstr("canopen_gateway_drive_alarm_active{drive=\"pump1\",kind=\"heartbeat\"} 1\n"));
  EXPECT_THAT(told, HasSubstr("canopen_gateway_drive_alarm_active{drive=\"fan1\",kind=\"heartbeat\"} 0\n"));
  EXPECT_THAT(told, HasSubstr("canopen_gateway_drive_heartbeat_losses_total{drive=\"pump1\"} 1\n"));
}

TEST_F(HttpMetrics, TellOfCommandsAndRefusals) {
  ASSERT_TRUE(set("fan1", "frequency_command", 20.0).has_value());
  ASSERT_TRUE(set("fan1", "frequency_command", 21.0).has_value());
  ASSERT_TRUE(set("fan1", "frequency_command", 51.0).has_error());
  const std::string told = text("/metrics");
  EXPECT_THAT(told, HasSubstr("canopen_gateway_commands_total{drive=\"fan1\",writer=\"local\",outcome=\"ok\"} 2\n"));
  EXPECT_THAT(told, HasSubstr("canopen_gateway_commands_total{drive=\"fan1\",writer=\"local\",outcome=\"range\"} 1\n"));
  EXPECT_THAT(told,
              HasSubstr("canopen_gateway_command_confirmation_seconds_count{drive=\"fan1\",writer=\"local\"} 2\n"));
  EXPECT_THAT(told, HasSubstr("canopen_gateway_command_confirmation_seconds_bucket{drive=\"fan1\",writer=\"local\","
                              "le=\"5\"} 2\n"));
  const auto before = gateway_.plant().find("fan1")->sdo_aborts().by_code();
  const auto read =
      support::spawn(loop_.executor(), gateway_.plant().find("fan1")->sdo_read({0x5FFF, 1}, canopen::DataType::u16));
  ASSERT_TRUE(loop_.advance_until([&] { return read.done(); }, 5s));
  ASSERT_TRUE(read.get().has_error());
  const std::uint32_t code = read.get().error().abort;
  const auto counted = gateway_.plant().find("fan1")->sdo_aborts().by_code();
  EXPECT_EQ(counted.at(code), (before.contains(code) ? before.at(code) : 0U) + 1U);
  EXPECT_THAT(text("/metrics"), ContainsRegex("canopen_gateway_drive_sdo_aborts_total.drive=\"fan1\",code=\"0x06"));
}

TEST_F(HttpMetrics, TellOfServersWhereThereAreSome) {
  ModbusFigures modbus{.clients = 3, .refused = 2};
  modbus.counts.requests = 7;
  modbus.counts.garbage = 8;
  modbus.counts.add(modbus::Exception::no_response);
  site_.modbus = [modbus] { return modbus; };
  site_.mqtt = [] {
    return MqttFigures{.connected = true, .counts = {.published = 11, .messages_dropped = 1, .answers_dropped = 2}};
  };
  site_.journal = [] { return JournalFigures{.lost = 4, .passed_by = 5}; };
  site_.http = [] { return HttpFigures{.clients = 1, .refused = 0, .answers = {{200U, 9U}}}; };
  site_.recorder = [] { return RecorderFigures{.works = false, .lost = 6}; };
  const std::string told = text("/metrics");
  for (const char* const line :
       {"canopen_gateway_modbus_clients 3\n", "canopen_gateway_modbus_refused_clients_total 2\n",
        "canopen_gateway_modbus_garbage_total 8\n", "canopen_gateway_modbus_requests_total 7\n",
        "canopen_gateway_modbus_exceptions_total{code=\"0x0B\"} 1\n",
        "canopen_gateway_modbus_exceptions_total{code=\"0x02\"} 0\n", "canopen_gateway_mqtt_connected 1\n",
        "canopen_gateway_mqtt_messages_published_total 11\n", "canopen_gateway_mqtt_answers_dropped_total 2\n",
        "canopen_gateway_recorder_works 0\n", "canopen_gateway_recorder_records_lost_total 6\n",
        "canopen_gateway_journal_lines_lost_total 4\n", "canopen_gateway_http_answers_total{status=\"200\"} 9\n"}) {
    EXPECT_THAT(told, HasSubstr(line));
  }
}

TEST_F(HttpMetrics, AreWordedADriveAtATime) {
  ASSERT_TRUE(set("fan1", "frequency_command", 20.0).has_value());
  ASSERT_TRUE(set("pump1", "frequency_command", 20.0).has_value());
  Answer answer = begin("/metrics");
  EXPECT_EQ(answer.text(), "");
  std::size_t pieces = 1;
  for (; answer.rest(answer.body).goes_on; ++pieces) {
    EXPECT_EQ(answer.text(), "") << "a metric of all drives stands together";
  }
  EXPECT_EQ(pieces, 1 + drives_.size());
  std::set<std::string> seen;
  std::string metric;
  std::istringstream lines(answer.body);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# TYPE ")) {
      metric = line.substr(7, line.find(' ', 7) - 7);
      EXPECT_TRUE(seen.insert(metric).second) << metric << " comes twice";
    } else if (!line.starts_with('#')) {
      EXPECT_TRUE(line.starts_with(metric)) << line;
    }
  }
  EXPECT_TRUE(seen.contains("canopen_gateway_commands_total"));
}

}  // namespace
}  // namespace gateway::http
