// What a boot writes of error control and of times: widths, and values that a drive rounds.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/canopen/error_control_setup_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class ErrorControlSetupTest : public ErrorControlSetupBench {
 protected:
  void hold_in_a_byte(ObjectAddress object) {
    slave_.set(object, DataType::u8, 0);
    slave_.script([object](const Bytes& request) -> Answers {
      const bool of_it = request[1] == (object.index & 0xFFU) && request[2] == object.index >> 8U;
      if (of_it && request[3] == object.sub && (request[0] & 0xE0U) == 0x20 && request[0] != 0x2F) {
        return std::vector<Bytes>{{0x80, request[1], request[2], request[3], 0x10, 0, 0x07, 0x06}};
      }
      return std::nullopt;
    });
  }
};

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

// A drive that holds a time in eight bits, and takes no other length.
TEST_F(ErrorControlSetupTest, WhatFitsIntoANarrowTimeIsWrittenInItsWidth) {
  NodeSettings settings = bench_settings();
  settings.error_control.heartbeat = 200ms;
  settings.error_control.heartbeat_timeout = 600ms;
  install(settings);
  hold_in_a_byte(kHeartbeatTime);
  boot(settings);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(written_widths(kHeartbeatTime), std::vector<unsigned>{1});
  EXPECT_EQ(slave_.value(kHeartbeatTime), 200U);
}

TEST_F(ErrorControlSetupTest, WhatDoesNotFitIntoItIsNeverCut) {
  install(bench_settings());
  hold_in_a_byte(kHeartbeatTime);
  boot(bench_settings());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(written_widths(kHeartbeatTime), (std::vector<unsigned>{2, 1}));
  EXPECT_EQ(slave_.value(kHeartbeatTime), 255U) << "the most that it holds";
  EXPECT_TRUE(remarked("0x1017:00 heartbeat time: expected 500, found 255 after it was written, which will do"));
}

TEST_F(ErrorControlSetupTest, NorDoesTheMostThatItHoldsStandForAnyTime) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].event_timer = std::uint16_t{600};
  settings.tpdos[0].period = 600ms;
  install(settings);
  hold_in_a_byte(kTpdoEventTimer);
  boot(settings);
  expect_letter(BootResult::not_configured, "TPDO1 event timer");
  EXPECT_EQ(written_widths(kTpdoEventTimer), std::vector<unsigned>{2});
}

TEST_F(ErrorControlSetupTest, OneThatShowsFewBytesAndTakesAllIsWrittenWhole) {
  install(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u8, 0);
  boot(bench_settings());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(written_widths(kHeartbeatTime), std::vector<unsigned>{2});
  EXPECT_EQ(slave_.value(kHeartbeatTime), 500U);
}

TEST_F(ErrorControlSetupTest, TheGuardTimeTooIsWrittenInTheWidthThatWasRead) {
  NodeSettings settings = guarded_each(500ms);
  settings.error_control.supervise_gateway = 1500ms;
  install(settings);
  slave_.set({0x100C, 0}, DataType::u32, 0);
  slave_.set({0x100D, 0}, DataType::u8, 0);
  slave_.answer_guarding(true);
  boot(settings);
  EXPECT_EQ(written_widths({0x100C, 0}), std::vector<unsigned>{4});
  EXPECT_EQ(slave_.value({0x100C, 0}), 500U);
  EXPECT_EQ(slave_.value({0x100D, 0}), 3U);
}

TEST_F(ErrorControlSetupTest, OtherWidthsStayAsTheyAre) {
  NodeSettings settings = bench_settings();
  settings.error_control.supervise_gateway = 2s;
  install(settings);
  slave_.set({0x1016, 0}, DataType::u8, 1);
  slave_.set({0x1016, 1}, DataType::u32, 0);
  slave_.set({0x1800, 2}, DataType::u8, 254);
  boot(settings);
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
