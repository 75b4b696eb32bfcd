// What SDO may take of a bus: how many transfers at once, and which load.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "canopen/sdo/budget.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/unit/canopen/sdo_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kBudgetBitrate = 120'000;  // A transfer of 240 bits takes 2 ms of it.

class SdoBudgetTest : public ::testing::Test {
 protected:
  void use(std::optional<std::uint32_t> bitrate, double most_load = SdoBudget::kUsualLoad) {
    claims.clear();
    budget = std::make_unique<SdoBudget>(loop.executor(), bitrate, most_load, load);
  }
  void claim(const std::string& name, TimePoint due = Clock::now()) {
    claims.push_back(std::make_unique<SdoBudget::Claim>(*budget, due, [this, name] { granted.push_back(name); }));
  }
  [[nodiscard]] std::size_t count_granted() const {
    return static_cast<std::size_t>(
        std::count_if(claims.begin(), claims.end(), [](const auto& entry) { return entry->granted(); }));
  }
  /// How many transfers a second are granted, each of which is answered at once, while others take so much of the bus.
  [[nodiscard]] std::size_t granted_in_a_second(unsigned others_per_mille = 0) {
    std::size_t count = 0;
    for (unsigned i = 0; i < 1000; ++i) {
      while (claims.size() < budget->most_at_once()) {
        claim("");
      }
      if (i * others_per_mille / 1000 != (i + 1) * others_per_mille / 1000) {
        load.add({.id = 0x185, .size = 8}, Clock::now());  // Lasts 1 ms.
      }
      loop.advance(1ms);
      count += count_granted();
      std::erase_if(claims, [](const auto& entry) { return entry->granted(); });
    }
    return count;
  }

  support::HandDrivenLoop loop;
  BusLoad load;
  std::unique_ptr<SdoBudget> budget;
  std::vector<std::unique_ptr<SdoBudget::Claim>> claims;
  std::vector<std::string> granted;
};

TEST_F(SdoBudgetTest, WithoutABitRateEightRunAtOnce) {
  use(std::nullopt);
  for (int i = 0; i < 12; ++i) {
    claim(std::to_string(i));
  }
  loop.settle();
  EXPECT_EQ(count_granted(), 8U);
  EXPECT_TRUE(granted.empty()) << "granted at once, nobody needs to be told";
  claims.erase(claims.begin(), claims.begin() + 2);
  loop.settle();
  EXPECT_EQ(granted, (std::vector<std::string>{"8", "9"}));
}

TEST_F(SdoBudgetTest, TheEarliestDueIsNextAndOfEqualOnesTheOldest) {
  use(std::nullopt);
  for (int i = 0; i < 8; ++i) {
    claim("");
  }
  const TimePoint now = Clock::now();
  claim("boot 1", now);
  claim("late poll", now + 5ms);
  claim("early poll", now - 5ms);
  claim("boot 2", now);
  claims.erase(claims.begin(), claims.begin() + 8);
  loop.settle();
  EXPECT_EQ(granted, (std::vector<std::string>{"early poll", "boot 1", "boot 2", "late poll"}));
}

TEST_F(SdoBudgetTest, SilentDrivesKeepNobodyFromHisTurn) {
  use(std::nullopt);
  for (int i = 0; i < 9; ++i) {
    claim(std::to_string(i));
  }
  loop.advance(49ms);
  EXPECT_TRUE(granted.empty());
  loop.advance(1ms);
  EXPECT_EQ(granted, std::vector<std::string>{"8"});
}

TEST_F(SdoBudgetTest, TheBitRateLimitsTheLoad) {
  use(kBudgetBitrate);
  EXPECT_NEAR(static_cast<double>(granted_in_a_second()), 350, 5);
  use(kBudgetBitrate, 0.5);
  EXPECT_NEAR(static_cast<double>(granted_in_a_second()), 250, 5);
}

TEST_F(SdoBudgetTest, OtherTrafficCountsAndATenthIsLeft) {
  use(kBudgetBitrate);
  static_cast<void>(granted_in_a_second(400));  // The load of the last second counts.
  EXPECT_NEAR(static_cast<double>(granted_in_a_second(400)), 150, 5);
  static_cast<void>(granted_in_a_second(1000));
  EXPECT_NEAR(static_cast<double>(granted_in_a_second(1000)), 50, 5);
}

TEST_F(SdoBudgetTest, SdoItselfIsNoOtherTraffic) {
  load.add({.id = 0x585, .size = 8}, Clock::now());
  load.add({.id = 0x605, .size = 8}, Clock::now());
  load.add({.id = 0x705, .size = 1}, Clock::now());
  loop.advance(100ms, 100ms);
  EXPECT_EQ(load.per_mille(1000, Clock::now()), 299U);
  EXPECT_EQ(load.others_per_mille(1000, Clock::now()), 59U);
}

TEST_F(SdoBudgetTest, WhatNobodyAskedForIsTakenFromTheOthers) {
  use(kBudgetBitrate);
  for (int i = 0; i < 10; ++i) {
    budget->charge();
  }
  claim("");
  EXPECT_EQ(count_granted(), 0U);
  loop.advance(23ms);
  EXPECT_EQ(count_granted(), 0U);
  loop.advance(2ms);
  EXPECT_EQ(count_granted(), 1U);
}

class SdoOnABusyBusTest : public SdoBench {
 protected:
  /// All places are taken.
  SdoOnABusyBusTest() {
    for (std::size_t i = 0; i < SdoBudget::kAtOnceWithoutBitrate; ++i) {
      taken.push_back(std::make_unique<SdoBudget::Claim>(bus_.sdo_budget(), Clock::now(), [] {}));
    }
    slave_.set(kStatus, DataType::u16, 1);
    slave_.set(kCommand, DataType::u16, 0);
  }
  ~SdoOnABusyBusTest() override { taken.clear(); }

  std::vector<std::unique_ptr<SdoBudget::Claim>> taken;
};

TEST_F(SdoOnABusyBusTest, CommandsWaitForNoBudgetNorForAReadThatDoes) {
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(1ms);
  EXPECT_TRUE(slave_.heard_on(0x605).empty());
  EXPECT_TRUE(command_now(kCommand, 5).has_value());
  EXPECT_FALSE(reading.done());
  taken.clear();
  loop_.advance(1ms);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().value(), 1U);
}

TEST_F(SdoOnABusyBusTest, WhoWaitsForBudgetIsInterruptedAtOnce) {
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(1ms);
  client_->interrupt();
  loop_.settle();
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::offline);
  taken.clear();
  loop_.advance(1s);
  EXPECT_TRUE(slave_.heard_on(0x605).empty());
}

}  // namespace
}  // namespace canopen
