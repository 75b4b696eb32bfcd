// Function 23 whose write is done when its read part fails.
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::Bytes;
using modbus_test::frame;
using modbus_test::kUnit;
using modbus_test::Site;
using modbus_test::TcpClient;
using std::chrono::milliseconds;

TEST(ReadWrite, TheLogSaysWhatWasWrittenThoughTheAnswerIsAnException) {
  Site site;
  site.bring_up();
  site.puppet().written.clear();
  site.remarks().clear();
  // A write of another client holds it up until its values are too old.
  TcpClient other(site.port());
  const Bytes slow = frame(kUnit, "06 012c 0001");
  const Bytes both = frame(kUnit, "17 0000 0001 0134 0001 02 0009");
  site.puppet().mute = true;
  EXPECT_EQ(other.send(slow), slow.size());
  site.run_without_values(milliseconds(50));
  EXPECT_EQ(site.client().send(both), both.size());
  site.settle();
  site.run_without_values(milliseconds(400));
  site.puppet().mute = false;
  EXPECT_TRUE(site.remarks().empty());
  site.run_without_values(milliseconds(600));
  EXPECT_EQ(site.answer(other), "86 0b");
  EXPECT_EQ(site.answer(site.client()), "97 0b");
  ASSERT_FALSE(site.puppet().written.empty());
  EXPECT_EQ(site.puppet().written.back().object, modbus_test::kRampObject);
  EXPECT_EQ(site.puppet().written.back().raw, 9U);
  ASSERT_EQ(site.remarks().size(), 1U);
  EXPECT_NE(site.remarks()[0].find("function 23"), std::string::npos) << site.remarks()[0];
  EXPECT_NE(site.remarks()[0].find("127.0.0.1"), std::string::npos) << site.remarks()[0];
  EXPECT_NE(site.remarks()[0].find("is not fresh any more; answered 0x0B"), std::string::npos) << site.remarks()[0];
}

TEST(ReadWrite, TheLogOfAStopThatCannotBeReadBackNamesTheExceptionThatWasAnswered) {
  config::Model model = modbus_test::example_model();
  model.drives[0].node.motor.control = modbus_test::kControlObject;
  model.drives[0].node.motor.stops = {{0xFFFF, 5}};
  Site site(model);
  site.bring_up();
  site.remarks().clear();
  EXPECT_EQ(site.ask("17 03e7 0001 0064 0001 02 0005"), "97 02") << "register 999 is none";
  ASSERT_EQ(site.remarks().size(), 1U);
  EXPECT_NE(site.remarks()[0].find("what it was to read cannot be read; answered 0x02"), std::string::npos)
      << site.remarks()[0];
}

TEST(ReadWrite, OneThatWasNotBegunIsNoRemark) {
  Site site;
  site.bring_up();
  site.run_without_values(milliseconds(700));
  site.puppet().written.clear();
  site.remarks().clear();
  EXPECT_EQ(site.ask("17 0000 0001 0134 0001 02 0009"), "97 0b");
  EXPECT_TRUE(site.puppet().written.empty());
  EXPECT_TRUE(site.remarks().empty());
}

}  // namespace
