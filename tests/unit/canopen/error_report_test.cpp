// What a drive says of its errors where NMT start has no effect: 0x1001 and 0x1003, in words.

#include "canopen/node/error_report.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr ObjectAddress kRegister{0x1001, 0};

TEST(ErrorRegisterText, NamesItsBits) {
  EXPECT_EQ(error_register_text(0), "");
  EXPECT_EQ(error_register_text(0x01), "generic error");
  EXPECT_EQ(error_register_text(0x2A), "current, temperature, device profile");
  EXPECT_EQ(error_register_text(0x94), "voltage, communication, manufacturer");
}

class IgnoredStartTest : public NodeLifeBench {
 protected:
  IgnoredStartTest() {
    install(bench_settings());
    slave_.ignore_nmt(true);
  }
  void boot_in_vain() {
    start(bench_settings());
    slave_.boot_up();
    ASSERT_TRUE(loop_.advance_until([this] { return is_letter(status().boot_result); }, 10s));
    EXPECT_EQ(status().boot_result, BootResult::not_configured);
    EXPECT_EQ(status().held_back, HeldBack::start_ignored);
    EXPECT_TRUE(told("NMT start was sent, but the drive stays pre-operational; its error register 0x1001 "))
        << status().boot_text;
  }
  void errors(std::initializer_list<Raw> newest_first) {
    slave_.set({0x1003, 0}, DataType::u8, newest_first.size());
    std::uint8_t sub = 0;
    for (const Raw error : newest_first) {
      slave_.set({0x1003, ++sub}, DataType::u32, error);
    }
  }
};

TEST_F(IgnoredStartTest, TheTextSaysWhatBothObjectsSay) {
  slave_.set(kRegister, DataType::u8, 0x11);
  errors({0x8130, 0x12342310});
  boot_in_vain();
  EXPECT_TRUE(
      told("is 0x11 (generic error, communication); its newest errors: 0x1003:01 is 0x00008130, 0x1003:02 is "
           "0x12342310"))
      << status().boot_text;
}

TEST_F(IgnoredStartTest, OfManyErrorsTheFourNewestAreRead) {
  slave_.set(kRegister, DataType::u8, 0x01);
  errors({1, 2, 3, 4, 5, 6});
  boot_in_vain();
  EXPECT_TRUE(told("0x1003:04 is 0x00000004")) << status().boot_text;
  EXPECT_FALSE(told("0x1003:05"));
}

TEST_F(IgnoredStartTest, OneWithoutErrorsSaysSo) {
  slave_.set(kRegister, DataType::u8, 0);
  errors({});
  boot_in_vain();
  EXPECT_TRUE(told("is 0x00 (no error); 0x1003 names no error")) << status().boot_text;
}

TEST_F(IgnoredStartTest, OneThatHasNeitherObjectSaysSo) {
  boot_in_vain();
  EXPECT_TRUE(told("cannot be read: ")) << status().boot_text;
  EXPECT_TRUE(told("0x06020000")) << status().boot_text;
  EXPECT_TRUE(told("0x1003 names no error")) << status().boot_text;
}

TEST_F(IgnoredStartTest, AFieldWithoutItsCountIsReadAllTheSame) {
  slave_.set(kRegister, DataType::u8, 0x01);
  slave_.set({0x1003, 1}, DataType::u32, 0x2310);
  boot_in_vain();
  EXPECT_TRUE(told("its newest errors: 0x1003:01 is 0x00002310")) << status().boot_text;
}

TEST_F(IgnoredStartTest, WhatIsNewAtTheNextTryIsToldThen) {
  slave_.set(kRegister, DataType::u8, 0x01);
  boot_in_vain();
  slave_.set(kRegister, DataType::u8, 0x04);
  EXPECT_TRUE(loop_.advance_until([this] { return told("is 0x04 (voltage)"); }, 10s)) << status().boot_text;
}

}  // namespace
}  // namespace canopen
