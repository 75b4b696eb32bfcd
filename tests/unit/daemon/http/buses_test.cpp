// What HTTP tells of the health of buses.
#include <gmock/gmock.h>

#include <algorithm>
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <string>

#include "tests/unit/daemon/http/shown_plant.h"

namespace gateway::http {
namespace {

using namespace std::chrono_literals;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class HttpBuses : public test::ShownPlant {
 protected:
  boost::json::object bus() { return json("/api/buses").as_array().at(0).as_object(); }
};

TEST_F(HttpBuses, ACleanBusHasFiguresAndNoSuspicion) {
  loop_.advance(10s);
  EXPECT_EQ(json("/api/buses").as_array().size(), 1U);
  const boost::json::object told = bus();
  EXPECT_EQ(told.at("name").as_string(), "demo");
  EXPECT_TRUE(told.at("suspicion").is_null());
  EXPECT_EQ(told.at("error_frames").as_object().at("most"), 0);
  EXPECT_EQ(told.at("transmit_errors").as_object().at("most"), 0);
  const boost::json::array& nodes = told.at("nodes").as_array();
  ASSERT_EQ(nodes.size(), 4U);
  const boost::json::object& pump = nodes.at(1).as_object();
  EXPECT_EQ(pump.at("node"), 5);
  EXPECT_EQ(pump.at("drive").as_string(), "pump1");
  const double margin = pump.at("margin").as_object().at("least").as_double();
  EXPECT_NEAR(1 - pump.at("longest_gap").as_double() / pump.at("timeout").as_double(), margin, 0.001);
  EXPECT_GT(margin, 0.5);
  EXPECT_GT(pump.at("sdo").as_object().at("count").as_int64(), 10);
  bool has_heartbeat = false;
  for (const boost::json::value& cob_id : told.at("cob_ids").as_array()) {
    const boost::json::object& each = cob_id.as_object();
    has_heartbeat = has_heartbeat || each.at("cob_id").as_string() == "0x705";
    EXPECT_GT(each.at("worst").as_double(), 0.0) << each.at("cob_id");
  }
  EXPECT_TRUE(has_heartbeat);
}

TEST_F(HttpBuses, TheGatewaySaysWhichDriveHasTheLeastMargin) {
  loop_.advance(5s);
  const boost::json::object shown = json("/api/gateway").as_object().at("buses").as_array().at(0).as_object();
  EXPECT_TRUE(shown.at("suspicion").is_null());
  double least = 1;
  const boost::json::object own = bus();
  for (const boost::json::value& node : own.at("nodes").as_array()) {
    least = std::min(least, node.as_object().at("margin").as_object().at("least").as_double());
  }
  EXPECT_EQ(shown.at("heartbeat_margin").as_object().at("least").as_double(), least);
}

TEST_F(HttpBuses, ADriveWithoutPowerHasNoGap) {
  loop_.advance(5s);
  const boost::json::value before = bus().at("nodes");
  drives_[1]->power_off();
  loop_.advance(20s);
  drives_[1]->power_on();
  loop_.advance(20s);
  const auto margin = [](const boost::json::value& nodes) {
    return nodes.as_array().at(1).as_object().at("margin").as_object().at("least").as_double();
  };
  EXPECT_NEAR(margin(bus().at("nodes")), margin(before), 0.05) << "its boot-up ended the silence";
}

TEST_F(HttpBuses, TheMetricsAreFew) {
  loop_.advance(5s);
  const std::string told = text("/metrics");
  for (const char* const kind : {"doubled_id", "alone", "bit_rate", "wiring", "overload"}) {
    EXPECT_THAT(told, HasSubstr("canopen_gateway_bus_suspicion{bus=\"demo\",kind=\"" + std::string(kind) + "\"} 0\n"));
  }
  EXPECT_THAT(told, ContainsRegex("canopen_gateway_drive_heartbeat_margin_ratio.drive=\"pump1\". 0[.][0-9]+\n"));
  EXPECT_THAT(told,
              ContainsRegex("canopen_gateway_drive_sdo_answer_seconds.drive=\"pump1\",percentile=\"50\". [0-9.e-]+\n"));
  EXPECT_THAT(told, Not(HasSubstr("0x185"))) << "no series of a COB-ID";
}

TEST_F(HttpBuses, WithoutSurveysThereIsNothingToTell) {
  site_.survey = {};
  EXPECT_EQ(text("/api/buses"), "[]");
  EXPECT_THAT(text("/api/gateway"), HasSubstr("\"suspicion\":null,\"heartbeat_margin\":null"));
  EXPECT_THAT(text("/metrics"), Not(HasSubstr("bus_suspicion")));
}

}  // namespace
}  // namespace gateway::http
