// What a boot writes of error control: the table of 0x1016, widths, and values that a drive rounds.

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "canopen/node/consumer_table.h"
#include "tests/unit/canopen/node_life_bench.h"

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

class ErrorControlSetupTest : public NodeLifeBench {
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
  [[nodiscard]] bool remarked(const std::string& part) const {
    return std::any_of(events_.remarks.begin(), events_.remarks.end(),
                       [&](const std::string& remark) { return remark.find(part) != std::string::npos; });
  }
  /// The length in bytes of each download of the object, in order.
  [[nodiscard]] std::vector<unsigned> written_widths(ObjectAddress object) const {
    std::vector<unsigned> widths;
    for (const Frame& frame : slave_.heard_on(0x605)) {
      const bool of_it =
          frame.data[1] == (object.index & 0xFFU) && frame.data[2] == object.index >> 8U && frame.data[3] == object.sub;
      if (of_it && (frame.data[0] & 0xE0U) == 0x20) {
        widths.push_back(4U - ((frame.data[0] >> 2U) & 3U));
      }
    }
    return widths;
  }
  /// It takes what is written, and shows another value.
  void round_to(ObjectAddress object, DataType type, Raw value) {
    slave_.on_write([this, object, type, value](ObjectAddress written) {
      if (written == object) {
        slave_.set(object, type, value);
      }
    });
  }
};

TEST_F(ErrorControlSetupTest, EntriesOfOthersStay) {
  install(supervised());
  set_table({0x00010064, 0x007F0064, kWantedEntry, 0});
  boot(supervised());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(table(), (std::vector<Raw>{0x00010064, 0, kWantedEntry, 0}));
}

TEST_F(ErrorControlSetupTest, AnEntryAsItShouldBeIsNotWritten) {
  install(supervised());
  set_table({0x00010064, kWantedEntry});
  boot(supervised());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(ErrorControlSetupTest, AFullTableIsLetterJ) {
  install(supervised());
  set_table({0x00010064, 0x00020064});
  boot(supervised());
  expect_letter(BootResult::not_configured, "each of its 2 entries watches over another node");
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(ErrorControlSetupTest, ARunningDriveWithAnotherEntryIsLeftAlone) {
  running(supervised());
  set_table({0, 0x007F0064});
  start(supervised());
  loop_.advance(2s);
  expect_left_alone("0x1016:02 consumer heartbeat time: expected 0x7F07D0, found 0x7F0064");
}

TEST_F(ErrorControlSetupTest, AHeartbeatTimeIsWrittenInTheWidthThatWasRead) {
  install(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u32, 1000);
  boot(bench_settings());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(written_widths(kHeartbeatTime), std::vector<unsigned>{4});
  EXPECT_EQ(slave_.value(kHeartbeatTime), 500U);
}

TEST_F(ErrorControlSetupTest, TimesOfPdosToo) {
  install(bench_settings());
  slave_.set(kTpdoEventTimer, DataType::u32, 0);
  boot(bench_settings());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(written_widths(kTpdoEventTimer), std::vector<unsigned>{4});
  EXPECT_TRUE(node_->tpdo_verified(1));
}

TEST_F(ErrorControlSetupTest, WhereThatLengthIsRefusedInTheirOwn) {
  install(bench_settings());
  slave_.set(kTpdoEventTimer, DataType::u32, 0);
  slave_.script([](const Bytes& request) -> Answers {
    if (request[0] == 0x23 && request[1] == 0x00 && request[2] == 0x18 && request[3] == 5) {
      return std::vector<Bytes>{{0x80, request[1], request[2], request[3], 0x10, 0, 0x07, 0x06}};
    }
    return std::nullopt;
  });
  boot(bench_settings());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(written_widths(kTpdoEventTimer), (std::vector<unsigned>{4, 2}));
  EXPECT_EQ(slave_.value(kTpdoEventTimer), 100U);
}

TEST_F(ErrorControlSetupTest, OtherWidthsStayAsTheyAre) {
  install(supervised());
  set_table({0});
  slave_.set({0x1800, 2}, DataType::u8, 254);
  boot(supervised());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(written_widths({0x1800, 2}), std::vector<unsigned>{1});
  EXPECT_EQ(written_widths({0x1016, 1}), std::vector<unsigned>{4});
}

TEST_F(ErrorControlSetupTest, ARoundedHeartbeatThatFitsIsARemark) {
  install(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  round_to(kHeartbeatTime, DataType::u16, 1000);
  boot(bench_settings());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_TRUE(remarked("0x1017:00 heartbeat time: expected 500, found 1000 after it was written, which will do"));
}

TEST_F(ErrorControlSetupTest, OneThatDoesNotFitIsLetterJ) {
  install(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  round_to(kHeartbeatTime, DataType::u16, 1500);
  boot(bench_settings());
  expect_letter(BootResult::not_configured, "expected 500, found 1500 after it was written");
}

struct Rounded {
  std::uint8_t sub;
  Raw shown;
  bool fits;
};

class RoundedTpdoTest : public ErrorControlSetupTest, public testing::WithParamInterface<Rounded> {
 protected:
  static NodeSettings with_inhibit_time() {
    NodeSettings settings = bench_settings();
    settings.tpdos[0].inhibit_time = std::uint16_t{200};  // 20 ms, with a period of 100 ms.
    return settings;
  }
};

TEST_P(RoundedTpdoTest, ATimeThatFitsWillDoInBootAndTakeover) {
  const ObjectAddress object{0x1800, GetParam().sub};
  install(with_inhibit_time());
  slave_.set(object, DataType::u16, 0);
  round_to(object, DataType::u16, GetParam().shown);
  boot(with_inhibit_time());
  EXPECT_EQ(status().online, GetParam().fits) << status().boot_text;
  EXPECT_EQ(remarked("after it was written, which will do"), GetParam().fits);
  EXPECT_EQ(node_->tpdo_verified(1), GetParam().fits);
}

TEST_P(RoundedTpdoTest, ATimeThatFitsWillDoInATakeover) {
  running(with_inhibit_time());
  slave_.set({0x1800, GetParam().sub}, DataType::u16, GetParam().shown);
  start(with_inhibit_time());
  loop_.advance(2s);
  EXPECT_EQ(status().online, GetParam().fits) << status().boot_text;
  EXPECT_EQ(status().boot_result == BootResult::left_alone, !GetParam().fits);
  expect_untouched();
}

INSTANTIATE_TEST_SUITE_P(Times, RoundedTpdoTest,
                         testing::Values(Rounded{5, 49, false}, Rounded{5, 50, true}, Rounded{5, 112, true},
                                         Rounded{5, 150, true}, Rounded{5, 151, false}, Rounded{3, 99, false},
                                         Rounded{3, 100, true}, Rounded{3, 500, true}, Rounded{3, 1000, true},
                                         Rounded{3, 1001, false}));

}  // namespace
}  // namespace canopen
