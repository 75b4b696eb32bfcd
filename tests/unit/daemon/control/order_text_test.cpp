#include "daemon/control/order_text.h"

#include <gtest/gtest.h>

namespace gateway::control {
namespace {

TEST(ControlOrderText, AWordIsANumberATruthOrAString) {
  EXPECT_EQ(json_of("30.0"), "30.0");
  EXPECT_EQ(json_of("-5"), "-5");
  EXPECT_EQ(json_of("1e3"), "1e3");
  EXPECT_EQ(json_of("18446744073709551615"), "18446744073709551615");
  EXPECT_EQ(json_of("true"), "true");
  EXPECT_EQ(json_of("run"), "\"run\"");
  EXPECT_EQ(json_of("null"), "\"null\"");
  EXPECT_EQ(json_of(""), "\"\"");
  EXPECT_EQ(json_of("5 Hz"), "\"5 Hz\"");
  EXPECT_EQ(json_of("\"5\""), "\"\\\"5\\\"\"");
  EXPECT_EQ(json_of("[1]"), "\"[1]\"");
  EXPECT_EQ(json_of("5\n"), "\"5\\n\"") << "a request is one line";
}

TEST(ControlOrderText, NumbersThatJsonWritesInAnotherWay) {
  EXPECT_EQ(json_of("050"), "50");
  EXPECT_EQ(json_of(".5"), "0.5");
  EXPECT_EQ(json_of("nan"), "\"nan\"");
  EXPECT_EQ(json_of("inf"), "\"inf\"");
}

TEST(ControlOrderText, OnlyARawValueMayBeHexadecimal) {
  EXPECT_EQ(json_of_raw("0x1F"), "31");
  EXPECT_EQ(json_of_raw("0xFFFFFFFFFFFFFFFF"), "18446744073709551615");
  EXPECT_EQ(json_of_raw("0x1FFFFFFFFFFFFFFFF"), "\"0x1FFFFFFFFFFFFFFFF\"");
  EXPECT_EQ(json_of_raw("0x"), "\"0x\"");
  EXPECT_EQ(json_of_raw("0x1G"), "\"0x1G\"");
  EXPECT_EQ(json_of_raw("-3"), "-3");
  EXPECT_EQ(json_of("0x1F"), "\"0x1F\"");
}

TEST(ControlOrderText, Assignments) {
  EXPECT_EQ(values_of({"frequency_command=30.0", "control_command=run=x"}),
            R"({"frequency_command":30.0,"control_command":"run=x"})");
  EXPECT_EQ(values_of({"frequency_command="}), R"({"frequency_command":""})");
  EXPECT_EQ(values_of({"frequency_command"}), std::nullopt);
  EXPECT_EQ(values_of({"=30"}), std::nullopt);
}

}  // namespace
}  // namespace gateway::control
