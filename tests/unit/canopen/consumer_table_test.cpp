// The table of 0x1016: the entry by which a node watches over us.

#include "canopen/node/consumer_table.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/unit/canopen/error_control_setup_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using Entries = std::vector<ConsumerEntry>;

constexpr Raw kWantedEntry = 0x007F07D0;  // Node 127, 2000 ms.

struct TableCase {
  const char* what;
  std::vector<Raw> found;
  std::optional<std::vector<ConsumerEntry>> plan;
};

std::ostream& operator<<(std::ostream& out, const TableCase& table) {
  return out << table.what;
}

class ConsumerTableTest : public testing::TestWithParam<TableCase> {};

TEST_P(ConsumerTableTest, ExactlyOneEntryWatchesOverUs) {
  Entries found;
  for (const Raw value : GetParam().found) {
    found.push_back({static_cast<std::uint8_t>(found.size() + 1), value});
  }
  EXPECT_EQ(plan_consumer_table(found, kWantedEntry), GetParam().plan);
}

INSTANTIATE_TEST_SUITE_P(
    Tables, ConsumerTableTest,
    testing::Values(TableCase{"the first free one", {0, 0}, Entries{{1, kWantedEntry}}},
                    TableCase{"a free one behind another node", {0x00010064, 0}, Entries{{2, kWantedEntry}}},
                    TableCase{"ours with another time is corrected", {0, 0x007F0064}, Entries{{2, kWantedEntry}}},
                    TableCase{"ours as it should be", {0x00010064, kWantedEntry}, Entries{{2, kWantedEntry}}},
                    TableCase{"ours without a time is reused", {0, 0x007F0000}, Entries{{2, kWantedEntry}}},
                    TableCase{"a node without a time is free", {0x00010000}, Entries{{1, kWantedEntry}}},
                    TableCase{"a time without a node is free", {0x00000064}, Entries{{1, kWantedEntry}}},
                    TableCase{"a double is cleared first",
                              {0x007F0064, kWantedEntry, kWantedEntry},
                              Entries{{1, 0}, {3, 0}, {2, kWantedEntry}}},
                    TableCase{"the reserved bits say nothing", {0, 0xFF7F07D0}, Entries{{2, kWantedEntry}}},
                    TableCase{"no entry is left", {0x00010064, 0x00020064}, std::nullopt},
                    TableCase{"no entry at all", {}, std::nullopt}));

class ConsumerSetupTest : public ErrorControlSetupBench {
 protected:
  static NodeSettings supervised() {
    NodeSettings settings = bench_settings();
    settings.error_control.supervise_gateway = 2s;
    return settings;
  }
  void set_table(const std::vector<Raw>& entries) {
    slave_.set({0x1016, 0}, DataType::u8, entries.size());
    std::uint8_t sub = 0;
    for (const Raw value : entries) {
      slave_.set({0x1016, ++sub}, DataType::u32, value);
    }
  }
  [[nodiscard]] std::vector<Raw> table() const {
    std::vector<Raw> entries;
    for (std::uint8_t sub = 1; sub <= slave_.value({0x1016, 0}); ++sub) {
      entries.push_back(slave_.value({0x1016, sub}));
    }
    return entries;
  }
};

TEST_F(ConsumerSetupTest, EntriesOfOthersStay) {
  install(supervised());
  set_table({0x00010064, 0x007F0064, kWantedEntry, 0});
  boot(supervised());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(table(), (std::vector<Raw>{0x00010064, 0, kWantedEntry, 0}));
}

TEST_F(ConsumerSetupTest, AnEntryAsItShouldBeIsNotWritten) {
  install(supervised());
  set_table({0x00010064, kWantedEntry});
  boot(supervised());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(ConsumerSetupTest, AFullTableIsLetterJ) {
  install(supervised());
  set_table({0x00010064, 0x00020064});
  boot(supervised());
  expect_letter(BootResult::not_configured, "each of its 2 entries watches over another node");
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(ConsumerSetupTest, ARunningDriveWithAnotherEntryIsLeftAlone) {
  running(supervised());
  set_table({0, 0x007F0064});
  start(supervised());
  loop_.advance(2s);
  expect_left_alone("0x1016:02 consumer heartbeat time: expected 0x7F07D0, found 0x7F0064");
}

TEST_F(ConsumerSetupTest, ATableWithHolesIsUsedWhereItHasAnEntry) {
  install(supervised());
  slave_.set({0x1016, 0}, DataType::u8, 4);
  slave_.set({0x1016, 2}, DataType::u32, 0x00010064);
  slave_.set({0x1016, 4}, DataType::u32, 0);
  boot(supervised());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(slave_.value({0x1016, 4}), kWantedEntry);
  EXPECT_EQ(slave_.value({0x1016, 2}), 0x00010064U);
}

TEST_F(ConsumerSetupTest, AnEntryOfOursThatCannotBeWrittenIsLetterJ) {
  install(supervised());
  set_table({0, 0x007F0064});
  slave_.refuse_write({0x1016, 2}, 0x06010002);
  boot(supervised());
  expect_letter(BootResult::not_configured, "0x1016:02");
}

TEST_F(ConsumerSetupTest, AReadOnlyEntryAsItShouldBeIsAllThatIsWanted) {
  install(supervised());
  set_table({kWantedEntry});
  slave_.refuse_write({0x1016, 1}, 0x06010002);
  boot(supervised());
  EXPECT_TRUE(status().online) << status().boot_text;
}

struct RoundedEntry {
  Raw shown;
  bool fits;
};

class RoundedConsumerTest : public ConsumerSetupTest, public testing::WithParamInterface<RoundedEntry> {};

TEST_P(RoundedConsumerTest, ATimeThatTripsALittleSoonerWillDoInABoot) {
  install(supervised());
  set_table({0});
  round_to({0x1016, 1}, DataType::u32, GetParam().shown);
  boot(supervised());
  EXPECT_EQ(status().online, GetParam().fits) << status().boot_text;
  EXPECT_EQ(remarked("after it was written, which will do"), GetParam().fits);
}

TEST_P(RoundedConsumerTest, ATimeThatTripsALittleSoonerWillDoInATakeover) {
  running(supervised());
  set_table({GetParam().shown});
  start(supervised());
  loop_.advance(2s);
  EXPECT_EQ(status().online, GetParam().fits) << status().boot_text;
  expect_untouched();
}

// 1499 ms, 1500 ms, 1984 ms, and later than wanted.
INSTANTIATE_TEST_SUITE_P(Times, RoundedConsumerTest,
                         testing::Values(RoundedEntry{0x007F05DB, false}, RoundedEntry{0x007F05DC, true},
                                         RoundedEntry{0x007F07C0, true}, RoundedEntry{0x007F07D1, false}));

TEST_F(ConsumerSetupTest, ReservedBitsAreNoDifference) {
  running(supervised());
  set_table({0xFF7F07D0});
  start(supervised());
  loop_.advance(2s);
  EXPECT_TRUE(status().online) << status().boot_text;
  expect_untouched();
}

/// `supervise_gateway`, our heartbeat and what the drive makes of the entry, in ms.
struct TightEntry {
  int supervise;
  int heartbeat;
  unsigned shown;
  bool fits;
};

class TightConsumerTest : public ConsumerSetupTest, public testing::WithParamInterface<TightEntry> {
 protected:
  static NodeSettings tight() {
    NodeSettings settings = bench_settings();
    settings.error_control.supervise_gateway = std::chrono::milliseconds(GetParam().supervise);
    settings.gateway_heartbeat = std::chrono::milliseconds(GetParam().heartbeat);
    return settings;
  }
  static Raw shown() { return 0x007F0000U | GetParam().shown; }
};

TEST_P(TightConsumerTest, NoneThatOneLateHeartbeatOfOursTripsWillDoInABoot) {
  install(tight());
  set_table({0});
  round_to({0x1016, 1}, DataType::u32, shown());
  boot(tight());
  EXPECT_EQ(status().online, GetParam().fits) << status().boot_text;
}

TEST_P(TightConsumerTest, NorInATakeover) {
  running(tight());
  set_table({shown()});
  start(tight());
  loop_.advance(2s);
  EXPECT_EQ(status().online, GetParam().fits) << status().boot_text;
  expect_untouched();
}

INSTANTIATE_TEST_SUITE_P(Times, TightConsumerTest,
                         testing::Values(TightEntry{600, 500, 599, false}, TightEntry{600, 500, 450, false},
                                         TightEntry{600, 500, 600, true}, TightEntry{1000, 500, 999, false},
                                         TightEntry{2000, 900, 1799, false}, TightEntry{2000, 900, 1800, true},
                                         TightEntry{2000, 500, 1500, true}));

/// `supervise_gateway` is not set, and our heartbeat comes each 500 ms.
class LeftEntryTest : public ConsumerSetupTest {
 protected:
  static NodeSettings unsupervised() {
    NodeSettings settings = bench_settings();
    settings.gateway_heartbeat = 500ms;
    return settings;
  }
};

TEST_F(LeftEntryTest, OneThatOurHeartbeatNeverKeepsIsClearedInABoot) {
  install(unsupervised());
  set_table({0x00010064, 0x007F0064});
  boot(unsupervised());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(table(), (std::vector<Raw>{0x00010064, 0}));
  EXPECT_TRUE(
      remarked("0x1016:02 has the gateway's node id: the drive trips when our heartbeat is missing for 100 ms, "
               "and it comes each 500 ms; left by another master, it was cleared"));
}

TEST_F(LeftEntryTest, OneThatCannotBeClearedIsNamed) {
  install(unsupervised());
  set_table({0x007F0064});
  slave_.refuse_write({0x1016, 1}, 0x06010002);
  boot(unsupervised());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_TRUE(remarked("it cannot be cleared: "));
}

TEST_F(LeftEntryTest, InATakeoverItIsOnlyNamed) {
  running(unsupervised());
  set_table({0x007F0064});
  start(unsupervised());
  loop_.advance(2s);
  EXPECT_TRUE(status().online) << status().boot_text;
  expect_untouched();
  EXPECT_TRUE(remarked("0x1016:01 has the gateway's node id"));
  EXPECT_TRUE(remarked("; clear it, or set supervise_gateway"));
}

// Somebody may want it so.
TEST_F(LeftEntryTest, OneThatOurHeartbeatBarelyKeepsIsOnlyNamed) {
  install(unsupervised());
  set_table({0x007F03E7});
  boot(unsupervised());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_TRUE(slave_.writes().empty());
  EXPECT_TRUE(remarked("is missing for 999 ms"));
}

TEST_F(LeftEntryTest, OneThatItKeepsAndThoseOfOthersAreNothingToTell) {
  install(unsupervised());
  set_table({0x007F03E8, 0x00010064, 0, 0x007F0000});
  boot(unsupervised());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_TRUE(slave_.writes().empty());
  EXPECT_TRUE(events_.remarks.empty());
}

TEST_F(LeftEntryTest, NorIsADriveWithoutTheTable) {
  install(unsupervised());
  boot(unsupervised());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_TRUE(events_.remarks.empty());
}

}  // namespace
}  // namespace canopen
