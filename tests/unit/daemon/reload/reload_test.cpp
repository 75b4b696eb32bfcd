#include "daemon/reload/reload.h"

#include <gmock/gmock.h>

#include <boost/json/parse.hpp>
#include <sstream>

#include "daemon/control/status_json.h"
#include "daemon/control/status_table.h"
#include "daemon/control/watch_stream.h"
#include "daemon/supervision.h"
#include "tests/unit/daemon/reload/reload_bench.h"

namespace gateway {
namespace {

TEST_F(ReloadTest, WhatIsTheSameIsNotTouched) {
  const process::Drive* const fan = &drive("fan1");
  reload();
  EXPECT_EQ(&drive("fan1"), fan);
  EXPECT_EQ(gateway_.plant().changes(), 0U);
  EXPECT_EQ(begins_, 1);
}

TEST_F(ReloadTest, OneWithErrorsChangesNothing) {
  const process::Drive* const fan = &drive("fan1");
  file_.drives[0].commands.lease = 5s;
  broken_ = true;
  reload();
  EXPECT_EQ(&drive("fan1"), fan);
  EXPECT_EQ(in_use(), model_);
}

TEST_F(ReloadTest, AnotherNameOfTheGatewayNeedsARestart) {
  file_.gateway.name = "other";
  file_.drives[0].commands.lease = 5s;
  reload();
  EXPECT_EQ(in_use(), model_);
}

TEST_F(ReloadTest, ADriveThatStandsIsReplacedAtOnce) {
  const process::Drive* const pump = &drive("pump1");
  file_.drives[0].commands.lease = 5s;
  reload();
  EXPECT_EQ(drive("fan1").model().commands.lease, 5s);
  EXPECT_EQ(&drive("pump1"), pump);
  EXPECT_TRUE(reload_.waiting().empty());
  EXPECT_TRUE(loop_.advance_until([&] { return drive("fan1").status().online; }, 10s));
  EXPECT_EQ(drive("pump1").status().heartbeat_losses, 0U);
}

TEST_F(ReloadTest, OneThatTurnsKeepsItsSectionUntilItStandsStill) {
  run_fan();
  file_.drives[0].commands.lease = 5s;
  file_.drives[1].commands.lease = 5s;
  reload();
  EXPECT_EQ(drive("fan1").model().commands.lease, 0s);
  EXPECT_EQ(drive("fan1").pending_change(), "waits for standstill");
  EXPECT_EQ(drive("pump1").model().commands.lease, 5s) << "the others do not wait for it";
  EXPECT_EQ(drive("pump1").pending_change(), "");
  EXPECT_THAT(status_line(gateway_.plant()), testing::EndsWith(" drives online, 1 to be changed at standstill"));
  const std::string told = control::status_json(gateway_.plant(), {}, canopen::Clock::now(), {});
  EXPECT_THAT(told, testing::HasSubstr("\"boot_text\":\"\",\"reload\":\"waits for standstill\""));
  EXPECT_THAT(control::status_table(told).value_or(""),
              testing::HasSubstr("fan1: its new configuration waits for standstill\n"));
  const process::Drive* const fan = &drive("fan1");
  loop_.advance(10s);
  EXPECT_EQ(&drive("fan1"), fan);
  EXPECT_TRUE(drive("fan1").status().online);
  EXPECT_NE(drive("fan1").image().raw(running_of("fan1")), 0U) << "it goes on running";
  stop_fan();
  ASSERT_TRUE(loop_.advance_until([&] { return drive("fan1").model().commands.lease == 5s; }, 30s));
  EXPECT_TRUE(reload_.waiting().empty());
  EXPECT_EQ(drive("fan1").pending_change(), "");
  EXPECT_EQ(drive("fan1").commanded().known(0), std::nullopt);
  EXPECT_TRUE(loop_.advance_until([&] { return drive("fan1").status().online; }, 10s));
}

TEST_F(ReloadTest, OneThatIsOnlyAboutToTurnWaitsToo) {
  write(0, {{"frequency_command", 30.0}, {"torque_command", 0.0}, {"control_command", 1.0}});
  file_.drives[0].commands.lease = 5s;
  reload();
  EXPECT_EQ(drive("fan1").pending_change(), "waits for standstill");
}

TEST_F(ReloadTest, ANewerConfigurationTakesThePlaceOfOneThatWaits) {
  run_fan();
  file_.drives[0].commands.lease = 5s;
  reload();
  ASSERT_FALSE(reload_.waiting().empty());
  file_ = model_;
  reload();
  EXPECT_TRUE(reload_.waiting().empty());
  EXPECT_EQ(drive("fan1").pending_change(), "");
  stop_fan();
  loop_.advance(30s);
  EXPECT_EQ(in_use(), model_);
}

TEST_F(ReloadTest, ARemovedOneThatTurnsStaysUntilItStandsStill) {
  run_fan();
  file_.drives.erase(file_.drives.begin());
  reload();
  ASSERT_NE(gateway_.plant().find("fan1"), nullptr);
  stop_fan();
  EXPECT_TRUE(loop_.advance_until([&] { return gateway_.plant().find("fan1") == nullptr; }, 30s));
  EXPECT_EQ(in_use(), file_);
  loop_.advance(5min);  // what left is forgotten
  EXPECT_EQ(gateway_.plant().online(), 3U);
}

TEST_F(ReloadTest, AnOfflineOneIsReplacedWhateverItWasCommanded) {
  run_fan();
  drives_[0]->power_off();
  ASSERT_TRUE(loop_.advance_until([&] { return !drive("fan1").status().online; }, 10s));
  file_.drives[0].commands.lease = 5s;
  reload();
  EXPECT_EQ(drive("fan1").model().commands.lease, 5s);
}

TEST_F(ReloadTest, OneWhoseStateIsNotKnownWaits) {
  run_fan();
  stop_fan();
  loop_.advance(20s);
  drives_[0]->misbehaviour().tpdo_length = 0;
  drives_[0]->misbehaviour().sdo_flaw = simulator::SdoFlaw::abort;
  loop_.advance(5s);
  ASSERT_TRUE(drive("fan1").status().online);
  ASSERT_EQ(drive("fan1").turning(), process::Turning::unknown);
  file_.drives[0].commands.lease = 5s;
  reload();
  EXPECT_EQ(drive("fan1").pending_change(),
            "waits, as nobody can tell whether its motor turns (`running` is not fresh): let it stand still, then "
            "disconnect or switch it off, or restart the gateway");
  drives_[0]->misbehaviour() = {};
  EXPECT_TRUE(loop_.advance_until([&] { return drive("fan1").model().commands.lease == 5s; }, 30s));
}

TEST_F(ReloadTest, ManyRequestsAreFewReloads) {
  for (int i = 0; i < 10; ++i) {
    reload_.request();
  }
  await([&] { return ends_ >= 1; });
  loop_.settle();
  EXPECT_LE(loads_, 2);
}

TEST_F(ReloadTest, ABusThatChangedTakesItsDrivesWithIt) {
  file_.buses[0].sdo_load = 0.5;
  reload();
  EXPECT_EQ(in_use(), file_);
  EXPECT_TRUE(loop_.advance_until([&] { return gateway_.plant().online() == 4; }, 10s));
  loop_.advance(5min);
  EXPECT_EQ(gateway_.plant().online(), 4U);
  EXPECT_FALSE(gateway_.plant().bus_alarm(0).active);
}

TEST_F(ReloadTest, ABusThatTurnsADriveStays) {
  run_fan();
  const process::Drive* const pump = &drive("pump1");
  file_.buses[0].sdo_load = 0.5;
  reload();
  EXPECT_EQ(in_use().buses[0].sdo_load, model_.buses[0].sdo_load);
  EXPECT_EQ(drive("pump1").pending_change(), "waits for the standstill of another drive");
  EXPECT_EQ(&drive("pump1"), pump);
  stop_fan();
  ASSERT_TRUE(loop_.advance_until([&] { return in_use().buses[0].sdo_load == 0.5; }, 30s));
  EXPECT_EQ(in_use(), file_);
}

TEST_F(ReloadTest, WhoWatchesTheStatusIsShownTheDrivesOfNow) {
  control::WatchStream watch(gateway_.plant(), "1", {});
  std::string told;
  while (watch.take(told)) {
  }
  (void)watch.take(told);
  told.clear();
  file_.drives.erase(file_.drives.begin() + 1);
  (void)watch.take(told);  // A status is begun.
  reload();
  for (int i = 0; i < 10; ++i) {
    loop_.advance(control::WatchStream::kPace);
    (void)watch.take(told);
  }
  std::istringstream lines(told);
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_NO_THROW((void)boost::json::parse(line)) << line;
    last = line;
  }
  EXPECT_THAT(last, testing::AllOf(testing::HasSubstr("\"name\":\"mixer1\""),
                                   testing::Not(testing::HasSubstr("\"name\":\"pump1\""))));
}

TEST_F(ReloadTest, SectionsComeAndGo) {
  const process::Drive* const fan = &drive("fan1");
  file_.modbus.emplace().listen = {{"127.0.0.1", 0}};
  file_.http.emplace().listen = {"127.0.0.1", 0};
  reload();
  EXPECT_NE(gateway_.http_port(), 0);
  EXPECT_EQ(&drive("fan1"), fan);
  file_.http->hosts = {"plant"};
  reload();
  EXPECT_NE(gateway_.http_port(), 0);
  file_.http.reset();
  file_.modbus.reset();
  reload();
  EXPECT_EQ(gateway_.http_port(), 0);
  EXPECT_EQ(&drive("fan1"), fan);
  loop_.advance(5s);
  EXPECT_EQ(gateway_.plant().online(), 4U);
}

}  // namespace
}  // namespace gateway
