// Where a node's emergencies go, 0x1014: looked at in every boot and takeover, written only where that is allowed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr ObjectAddress kEmcyId{0x1014, 0};
constexpr Raw kOff = 0x80000000;
constexpr Raw kWanted = 0x80 + kTestNode;
constexpr Raw kElsewhere = 0x90;

class EmcySetupTest : public NodeBench {
 protected:
  EmcySetupTest() { install(settings_); }

  void set(Raw value) { slave_.set(kEmcyId, DataType::u32, value); }
  void boot_now() {
    boot(settings_);
    EXPECT_TRUE(status().online) << status().boot_text;
    EXPECT_EQ(status().boot_result, BootResult::ok);
  }
  [[nodiscard]] EmcyVerdict verdict() const {
    EXPECT_EQ(events_.emcy_verdicts.size(), 1U);
    return events_.emcy_verdicts.empty() ? EmcyVerdict{EmcyService::moved, "never told"} : events_.emcy_verdicts.back();
  }
  // The values of writes to 0x1014, in their order.
  [[nodiscard]] std::vector<Raw> written() const {
    std::vector<Raw> values;
    for (const Frame& frame : slave_.heard_on(0x600 + kTestNode)) {
      if (frame.data[0] >> 5U == 1 && frame.data[1] == 0x14 && frame.data[2] == 0x10) {
        values.push_back(Raw{frame.data[4]} | Raw{frame.data[5]} << 8U | Raw{frame.data[6]} << 16U |
                         Raw{frame.data[7]} << 24U);
      }
    }
    return values;
  }
  [[nodiscard]] std::ptrdiff_t reads() const {
    const std::vector<ObjectAddress> all = slave_.reads();
    return std::count(all.begin(), all.end(), kEmcyId);
  }

  NodeSettings settings_ = bench_settings();
};

TEST_F(EmcySetupTest, AsExpectedIsReadOnceAndNothingIsSaid) {
  set(kWanted);
  boot_now();
  EXPECT_EQ(verdict(), EmcyVerdict{});
  EXPECT_EQ(reads(), 1);
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(EmcySetupTest, TheReservedBitSaysNothing) {
  set(kWanted | 0x40000000);
  boot_now();
  EXPECT_EQ(verdict(), EmcyVerdict{});
}

TEST_F(EmcySetupTest, ANodeWithoutTheObjectHasNothingToSay) {
  boot_now();
  EXPECT_EQ(verdict(), EmcyVerdict{});
  EXPECT_EQ(reads(), 1);
}

TEST_F(EmcySetupTest, ANodeThatDoesNotAnswerIsNoFailureAndNoVerdict) {
  set(kWanted);
  slave_.mute(kEmcyId);
  start(settings_);
  slave_.boot_up();
  EXPECT_TRUE(wait_online(10s)) << status().boot_text;
  EXPECT_TRUE(events_.emcy_verdicts.empty());
}

TEST_F(EmcySetupTest, SwitchedOffOrMovedIsToldAndLeftSo) {
  for (const Raw value : {kOff | kWanted, kOff | kElsewhere}) {
    set(value);
    events_.emcy_verdicts.clear();
    slave_.forget_heard();
    node_.reset();
    boot_now();
    EXPECT_EQ(verdict().service, EmcyService::off);
    EXPECT_THAT(verdict().text, HasSubstr("switched off in the drive: 0x1014:00 is 0x800000"));
    EXPECT_TRUE(slave_.writes().empty());
    const auto stopped = support::spawn(loop_.executor(), node_->stop());
    loop_.settle();
    ASSERT_TRUE(*stopped);
  }
}

TEST_F(EmcySetupTest, AnotherCobIdIsTold) {
  for (const Raw value : {kElsewhere, Raw{0x80}, Raw{0x20000000} | kWanted}) {
    set(value);
    events_.emcy_verdicts.clear();
    node_.reset();
    boot_now();
    EXPECT_EQ(verdict().service, EmcyService::moved) << value;
    EXPECT_THAT(verdict().text, HasSubstr("expected 0x00000085"));
    EXPECT_TRUE(slave_.writes().empty());
    const auto stopped = support::spawn(loop_.executor(), node_->stop());
    loop_.settle();
    ASSERT_TRUE(*stopped);
  }
}

TEST_F(EmcySetupTest, WhereAllowedItIsSwitchedOnInOneWriteAndReadBack) {
  settings_.emcy.enable = true;
  set(kOff | kElsewhere);
  boot_now();
  EXPECT_EQ(written(), std::vector<Raw>{kWanted});
  EXPECT_EQ(reads(), 2);
  EXPECT_EQ(verdict(), EmcyVerdict{});
  EXPECT_THAT(events_.remarks, testing::Contains(HasSubstr("0x1014:00 EMCY was 0x80000090 and is 0x00000085 now")));
}

TEST_F(EmcySetupTest, OneThatExistsIsSwitchedOffBeforeItIsMoved) {
  settings_.emcy.enable = true;
  set(kElsewhere);
  boot_now();
  EXPECT_EQ(written(), (std::vector<Raw>{kOff | kElsewhere, kWanted}));
  EXPECT_EQ(verdict(), EmcyVerdict{});
}

TEST_F(EmcySetupTest, AsExpectedIsNotWritten) {
  settings_.emcy.enable = true;
  set(kWanted);
  boot_now();
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(EmcySetupTest, ARefusedWriteIsToldAndNoFailure) {
  settings_.emcy.enable = true;
  set(kOff | kWanted);
  slave_.refuse_write(kEmcyId, 0x06010002);
  boot_now();
  EXPECT_EQ(verdict().service, EmcyService::off);
  EXPECT_THAT(verdict().text, HasSubstr("writing it failed"));
  EXPECT_THAT(verdict().text, HasSubstr("0x06010002"));
}

TEST_F(EmcySetupTest, AnIgnoredWriteIsTold) {
  settings_.emcy.enable = true;
  set(kOff | kWanted);
  slave_.ignore_write(kEmcyId);
  boot_now();
  EXPECT_EQ(verdict().service, EmcyService::off);
  EXPECT_THAT(verdict().text, HasSubstr("after it was written"));
}

TEST_F(EmcySetupTest, OneThatCannotBeMovedIsLeftWhereItWas) {
  settings_.emcy.enable = true;
  set(kElsewhere);
  slave_.on_write([this](ObjectAddress object) {
    if (object == kEmcyId) {
      slave_.refuse_write(kEmcyId, 0x06090030);  // Every write but the first.
    }
  });
  boot_now();
  EXPECT_EQ(written(), (std::vector<Raw>{kOff | kElsewhere, kWanted, kElsewhere}));
  EXPECT_EQ(verdict().service, EmcyService::off) << "putting it back was refused, too: the truth is told";
}

TEST_F(EmcySetupTest, ARunningNodeIsOnlyLookedAt) {
  settings_.emcy.enable = true;
  running(settings_);
  set(kOff | kWanted);
  start(settings_);
  loop_.advance(50ms);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::taken_over});
  EXPECT_EQ(verdict().service, EmcyService::off);
  EXPECT_EQ(reads(), 1);
  expect_untouched();
}

TEST_F(EmcySetupTest, ASettingOfTheSiteComesFirst) {
  settings_.setup = {{kEmcyId, DataType::u32, kOff | kWanted}};
  set(kWanted);
  boot_now();
  EXPECT_EQ(verdict().service, EmcyService::off);
}

}  // namespace
}  // namespace canopen
