#include "daemon/http/respond.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <string>

#include "daemon/http/alarm_list.h"
#include "tests/unit/daemon/http/shown_plant.h"

namespace gateway::http {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class HttpRespond : public test::ShownPlant {};

TEST_F(HttpRespond, NamesWhatThereIsWhereThereIsNothing) {
  const Answer answer = get("/api/nothing");
  EXPECT_EQ(answer.status, 404U);
  EXPECT_EQ(answer.text(),
            R"({"error":"there is no /api/nothing","resources":["/","/metrics","/health","/api/drives",)"
            R"("/api/drives/NAME","/api/gateway","/api/buses","/api/alarms","/api/records","/api/map","/api/history",)"
            R"("/api/live","/api/trace","/api/commands","/records/NAME"]})");
  EXPECT_EQ(get("/page").status, 404U);
  EXPECT_EQ(get("/api/drives/pump9").text(),
            R"({"error":"there is no drive \"pump9\"","drives":["fan1","pump1","hoist1","mixer1"]})");
  EXPECT_EQ(get("/api/drives/pump9").status, 404U);
  EXPECT_EQ(get("/api/drives/").status, 404U);
}

TEST_F(HttpRespond, RefusesParametersThatMeanNothing) {
  EXPECT_EQ(get("/health?verbose=1").status, 400U);
  EXPECT_EQ(get("/api/commands?cuont=5").text(),
            R"({"error":"/api/commands knows no parameter \"cuont\"","parameters":["count"]})");
  EXPECT_EQ(get("/api/drives/pump1?x").status, 400U);
}

TEST_F(HttpRespond, HealthIsThatOfTheBrokerAndTellsAMonitor) {
  const boost::json::object well = json("/health").as_object();
  EXPECT_EQ(well.at("drives_online").as_int64(), 4);
  EXPECT_EQ(well.at("buses").as_array().at(0).as_object().at("state").as_string(), "active");
  boost::json::object told_the_broker = boost::json::parse(process::health_json(gateway_.health())).as_object();
  boost::json::object told_here = json("/health").as_object();
  EXPECT_GT(told_here.at("memory").as_int64(), 0);
  told_here["memory"] = told_the_broker["memory"];  // of another moment
  EXPECT_EQ(told_here, told_the_broker);
  wire_.set_state({canopen::BusCondition::passive, 130, 0});
  loop_.advance(10ms);
  EXPECT_EQ(get("/health").status, 200U) << "it still carries frames";
  wire_.set_state({canopen::BusCondition::bus_off, 0, 0});
  loop_.advance(10ms);
  EXPECT_EQ(get("/health").status, 503U);
  EXPECT_THAT(get("/health").body, HasSubstr("\"state\":\"bus-off\""));
}

TEST(HttpHealth, WithoutADriveNothingIsWell) {
  process::Health health{.buses = {{.name = "can0", .condition = canopen::BusCondition::error_active}}, .drives = 2};
  EXPECT_TRUE(process::is_well(health)) << "no drive is in service";
  health.in_service = 2;
  EXPECT_FALSE(process::is_well(health));
  health.online = 1;
  EXPECT_TRUE(process::is_well(health));
  health.buses.push_back({.name = "can1", .condition = canopen::BusCondition::down});
  EXPECT_FALSE(process::is_well(health));
  health.buses.back().in_service = false;
  EXPECT_TRUE(process::is_well(health)) << "a spare bus, or one whose drives are all switched off for the winter";
}

TEST_F(HttpRespond, FiguresOfTheGateway) {
  boost::json::object figures = json("/api/gateway").as_object();
  EXPECT_EQ(figures.at("name").as_string(), model_.gateway.name);
  EXPECT_EQ(figures.at("health").as_object().at("drives_online").as_int64(), 4);
  EXPECT_TRUE(figures.at("modbus").is_null()) << "there is none";
  wire_.set_state({canopen::BusCondition::passive, 130, 7});
  site_.modbus = [] {
    modbus::Counts counts{.requests = 40};
    counts.add(modbus::Exception::illegal_address);
    counts.add(modbus::Exception::unknown_unit);
    return ModbusFigures{.clients = 3, .refused = 1, .counts = counts};
  };
  loop_.advance(10ms);
  figures = json("/api/gateway").as_object();
  const boost::json::object bus = figures.at("buses").as_array().at(0).as_object();
  EXPECT_EQ(bus.at("transmit_errors").as_int64(), 130);
  EXPECT_EQ(bus.at("receive_errors").as_int64(), 7);
  EXPECT_GT(bus.at("frames_received").as_int64(), 0);
  EXPECT_EQ(boost::json::serialize(figures.at("modbus")), R"({"clients":3,"refused":1,"requests":40,"exceptions":2})");
}

TEST_F(HttpRespond, ThePageIsPartOfTheProgram) {
  const Answer page = get("/");
  EXPECT_EQ(page.status, 200U);
  EXPECT_EQ(page.type, "text/html; charset=utf-8");
  EXPECT_TRUE(page.page);
  EXPECT_THAT(page.body, HasSubstr("<title>canopen-gateway</title>"));
  EXPECT_EQ(get("/page/main.js").type, "text/javascript; charset=utf-8");
  EXPECT_EQ(get("/page/page.css").type, "text/css; charset=utf-8");
  EXPECT_EQ(get("/page/icon.svg").type, "image/svg+xml");
  EXPECT_EQ(get("/page/package.json").status, 404U) << "what only tests need";
  EXPECT_EQ(get("/?x=1").status, 400U);
  EXPECT_FALSE(get("/health").page);
}

TEST_F(HttpRespond, ChartsAreThereWhereTheMachineHasTheirLibrary) {
  site_.charts.clear();
  EXPECT_EQ(get("/page/dygraph.js").status, 404U);
  site_.charts = "var Dygraph;";
  EXPECT_EQ(get("/page/dygraph.js").text(), "var Dygraph;");
  EXPECT_TRUE(get("/page/dygraph.js").body.empty()) << "it is not copied for each client";
  EXPECT_EQ(get("/page/dygraph.js").type, "text/javascript; charset=utf-8");
}

TEST_F(HttpRespond, DrivesAreShownWithTheirValues) {
  const boost::json::array all = json("/api/drives").as_array();
  ASSERT_EQ(all.size(), 4U);
  const boost::json::object one = json("/api/drives/pump1").as_object();
  EXPECT_EQ(one.at("name").as_string(), "pump1");
  EXPECT_EQ(one.at("nmt").as_string(), "operational");
  EXPECT_FALSE(one.at("values").as_object().at("running").as_bool());
  EXPECT_EQ(all.at(1).as_object().at("node"), one.at("node"));
}

TEST_F(HttpRespond, AlarmsAreThoseThatAreActive) {
  EXPECT_EQ(text("/api/alarms"), "[]");
  drives_[1]->power_off();
  loop_.advance(5s);
  const boost::json::array active = json("/api/alarms").as_array();
  ASSERT_EQ(active.size(), 1U);
  EXPECT_EQ(active.at(0).as_object().at("drive").as_string(), "pump1");
  EXPECT_EQ(active.at(0).as_object().at("kind").as_string(), "heartbeat");
}

TEST_F(HttpRespond, AlarmsAreWordedInPiecesAndOfOneMoment) {
  for (const auto& drive : drives_) {
    drive->power_off();
  }
  loop_.advance(5s);
  AlarmList list(site_.plant);
  std::string pieces;
  EXPECT_TRUE(list.word(pieces, 3).goes_on);
  EXPECT_EQ(std::ranges::count(pieces, '{'), 3);
  drives_[1]->power_on();
  loop_.advance(5s);
  EXPECT_FALSE(list.word(pieces, 3).goes_on);
  EXPECT_EQ(boost::json::parse(pieces).as_array().size(), 4U) << "as it was when the first piece was worded";
  EXPECT_EQ(json("/api/alarms").as_array().size(), 3U);
}

TEST_F(HttpRespond, AHistoryThatIsStoppedAsItsTimerExpiresStaysSo) {
  canopen::Timer first(loop_.executor());
  first.expires_after(History::kPeriod);
  first.async_wait([this](const boost::system::error_code& /*error*/) { history_.stop(); });
  history_.start();
  loop_.advance(5s);
  EXPECT_TRUE(json("/api/history?drive=pump1").as_object().at("samples").as_array().empty());
}

TEST_F(HttpRespond, TheMapIsThatOfTheCommandLine) {
  EXPECT_EQ(text("/api/map"), render_map_json(model_));
  EXPECT_TRUE(get("/api/map").body.empty()) << "it is not copied for each client";
}

TEST_F(HttpRespond, TheHistoryIsThatOfADrive) {
  EXPECT_EQ(json("/api/history?drive=pump1").as_object().at("drive").as_string(), "pump1");
  EXPECT_EQ(get("/api/history").status, 400U);
  EXPECT_EQ(get("/api/history?drive=pump9").text(),
            R"({"error":"there is no drive \"pump9\"","drives":["fan1","pump1","hoist1","mixer1"]})");
}

TEST_F(HttpRespond, HistoryTakesASampleASecondForTenMinutes) {
  history_.start();
  loop_.advance(3s + 1ms);
  drives_[1]->power_off();
  loop_.advance(3s);
  const boost::json::object told = json("/api/history?drive=pump1").as_object();
  const boost::json::array& signals = told.at("signals").as_array();
  const boost::json::array& samples = told.at("samples").as_array();
  ASSERT_EQ(samples.size(), 6U);
  ASSERT_EQ(samples.at(0).as_array().size(), signals.size() + 1);
  const auto* const voltage = std::ranges::find(signals, "dc_bus_voltage");
  ASSERT_NE(voltage, signals.end());
  const auto at = static_cast<std::size_t>(voltage - signals.begin()) + 1;
  EXPECT_GT(samples.at(0).as_array().at(at).to_number<double>(), 100.0) << "engineering units";
  EXPECT_TRUE(samples.at(5).as_array().at(at).is_null()) << "it is not fresh any more";
  EXPECT_LT(samples.at(0).as_array().at(0).as_string(), samples.at(1).as_array().at(0).as_string());
  loop_.advance(700s, 100ms);
  EXPECT_EQ(json("/api/history?drive=pump1").as_object().at("samples").as_array().size(), History::kSamples);
  history_.stop();
}

TEST_F(HttpRespond, DrivesAreWordedOneAtATime) {
  Answer answer = begin("/api/drives");
  std::size_t pieces = 1;
  for (; answer.rest(answer.body).goes_on; ++pieces) {
    EXPECT_THAT(answer.body, testing::EndsWith("}"));
  }
  EXPECT_EQ(pieces, drives_.size());
}

TEST_F(HttpRespond, APieceOfHistoryIsBounded) {
  history_.start();
  loop_.advance(700s, 100ms);
  Answer answer = begin("/api/history?drive=pump1");
  std::size_t pieces = 0;
  for (bool goes_on = true; goes_on; ++pieces) {
    const std::size_t before = answer.body.size();
    goes_on = answer.rest(answer.body).goes_on;
    EXPECT_LE(std::count(answer.body.begin() + static_cast<std::ptrdiff_t>(before), answer.body.end(), ','),
              static_cast<std::ptrdiff_t>(History::kValuesOfPiece) + 100)
        << "100: what stands in front of the samples";
  }
  EXPECT_GT(pieces, 5U);
  EXPECT_EQ(boost::json::parse(answer.body).at("samples").as_array().size(), History::kSamples);
  answer = begin("/api/history?drive=pump1");
  loop_.advance(3s, 100ms);
  while (answer.rest(answer.body).goes_on) {
  }
  EXPECT_EQ(boost::json::parse(answer.body).at("samples").as_array().size(), History::kSamples - 3)
      << "three were overwritten before they were worded";
  history_.stop();
}

TEST_F(HttpRespond, CommandsAreTheNewestLinesOfTheJournal) {
  EXPECT_EQ(get("/api/commands").status, 404U);
  EXPECT_THAT(std::string(get("/api/commands").text()), HasSubstr("state_dir is empty"));
  site_.journal_lines = [this]() -> const std::deque<std::string>& { return journal_; };
  EXPECT_EQ(text("/api/commands"), "[]");
  for (int i = 1; i <= 60; ++i) {
    journal_.push_back("{\"n\":" + std::to_string(i) + "}");
  }
  EXPECT_EQ(json("/api/commands").as_array().size(), 50U);
  EXPECT_EQ(text("/api/commands?count=2"), R"([{"n":59},{"n":60}])");
  for (const char* const bad : {"0", "201", "-1", "5x", "", "99999999999999999999"}) {
    EXPECT_EQ(get("/api/commands?count=" + std::string(bad)).status, 400U) << bad;
  }
  EXPECT_EQ(get("/api/commands?count=x").text(), R"({"error":"count=\"x\": write a number from 1 to 200"})");
}

}  // namespace
}  // namespace gateway::http
