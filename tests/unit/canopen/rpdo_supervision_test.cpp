// An event timer of an RPDO that somebody relies on: it is in the drive, or the drive is not started.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

constexpr ObjectAddress kTimer{0x1400, 5};

class RpdoSupervisionTest : public NodeBench {
 protected:
  static NodeSettings supervised(SetupPolicy policy = SetupPolicy::write) {
    NodeSettings settings = bench_settings();
    PdoSettings& rpdo = settings.rpdos[0];
    rpdo.event_timer = std::uint16_t{300};
    rpdo.event_timer_required = true;
    rpdo.communication = policy;
    rpdo.mapping_policy = policy;
    return settings;
  }
  void remove_communication() {
    for (std::uint8_t sub = 0; sub <= 5; ++sub) {
      slave_.remove({0x1400, sub});
    }
  }
};

TEST_F(RpdoSupervisionTest, ItIsWrittenAndReadBackWhateverIsAssumed) {
  for (const SetupPolicy policy : {SetupPolicy::write, SetupPolicy::assume}) {
    const NodeSettings settings = supervised(policy);
    install(settings);
    slave_.set(kTimer, DataType::u16, 0);
    slave_.forget_heard();
    boot(settings);
    EXPECT_TRUE(status().online) << status().boot_text;
    EXPECT_EQ(slave_.value(kTimer), 300U);
    EXPECT_EQ(slave_.value({0x1400, 1}), 0x40000205U);
    EXPECT_EQ(slave_.writes(), (std::vector<ObjectAddress>{{0x1400, 1}, kTimer, {0x1400, 1}}));
    const std::vector<ObjectAddress> reads = slave_.reads();
    ASSERT_GE(reads.size(), 2U);
    EXPECT_EQ(reads[reads.size() - 2], kTimer);
    EXPECT_EQ(reads.back(), (ObjectAddress{0x1014, 0})) << "no PDO's";
    const auto stopped = support::spawn(loop_.executor(), node_->stop());
    loop_.settle();
  }
}

TEST_F(RpdoSupervisionTest, ADriveWithoutTheTimerIsNotStarted) {
  for (const SetupPolicy policy : {SetupPolicy::write, SetupPolicy::verify, SetupPolicy::assume}) {
    install(supervised(policy));
    slave_.remove(kTimer);
    boot(supervised(policy));
    expect_letter(BootResult::not_configured, "0x1400:05 RPDO1 event timer: the drive does not have it");
    EXPECT_TRUE(slave_.writes().empty());
    const auto stopped = support::spawn(loop_.executor(), node_->stop());
    loop_.settle();
  }
}

TEST_F(RpdoSupervisionTest, NorIsOneWithoutTheWholeObject) {
  for (const SetupPolicy policy : {SetupPolicy::write, SetupPolicy::verify, SetupPolicy::assume}) {
    install(supervised(policy));
    remove_communication();
    boot(supervised(policy));
    expect_letter(BootResult::not_configured, "0x1400:05 RPDO1 event timer: the drive does not have it");
    const auto stopped = support::spawn(loop_.executor(), node_->stop());
    loop_.settle();
  }
}

TEST_F(RpdoSupervisionTest, NorIsOneThatKeepsAnotherTime) {
  install(supervised());
  slave_.set(kTimer, DataType::u16, 0);
  slave_.ignore_write(kTimer);
  boot(supervised());
  expect_letter(BootResult::not_configured, "0x1400:05 RPDO1 event timer: expected 300, found 0 after it was written");
}

TEST_F(RpdoSupervisionTest, NorIsOneThatRefusesIt) {
  install(supervised());
  slave_.set(kTimer, DataType::u16, 0);
  slave_.refuse_write(kTimer, 0x06010002);
  boot(supervised());
  expect_letter(BootResult::not_configured, "writing RPDO1 event timer");
}

TEST_F(RpdoSupervisionTest, ARunningDriveWithoutTheTimerIsNotTakenOver) {
  running(supervised());
  slave_.remove(kTimer);
  start(supervised());
  loop_.advance(std::chrono::seconds(2));
  expect_letter(BootResult::not_configured, "0x1400:05 RPDO1 event timer: the drive does not have it");
  expect_untouched();
}

TEST_F(RpdoSupervisionTest, WhereNobodyReliesOnItItsAbsenceIsTheDocumentedDefault) {
  NodeSettings settings = supervised();
  settings.rpdos[0].event_timer_required = false;
  install(settings);
  slave_.remove(kTimer);
  boot(settings);
  EXPECT_TRUE(status().online) << status().boot_text;
}

}  // namespace
}  // namespace canopen
