#include "bridges/modbus/admission.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

namespace {

using boost::asio::ip::make_address;
using modbus::admit;
using modbus::Caller;
using std::chrono::seconds;

const canopen::TimePoint kNow = canopen::TimePoint{} + std::chrono::hours(1);

Caller reader(int host, int silent = 1) {
  return {make_address("192.0.2." + std::to_string(host)), false, kNow - seconds(silent)};
}

Caller writer(int host, int silent = 1) {
  return {make_address("198.51.100." + std::to_string(host)), true, kNow - seconds(silent)};
}

Caller commanding(Caller caller) {
  caller.silent_since.reset();
  return caller;
}

TEST(Admission, WhereThereIsRoomNobodyLeaves) {
  const auto admission = admit(reader(9), std::vector{reader(1), writer(2)}, 3, kNow);
  EXPECT_EQ(admission.refusal, nullptr);
  EXPECT_FALSE(admission.instead_of);
}

TEST(Admission, HalfOfTheRoomForOneAddress) {
  EXPECT_EQ(admit(reader(1), std::vector{reader(1), reader(1)}, 5, kNow).refusal, nullptr);  // the third of five
  EXPECT_NE(admit(reader(1), std::vector{reader(1), reader(1), reader(1)}, 5, kNow).refusal, nullptr);
  EXPECT_NE(admit(writer(1), std::vector{writer(1)}, 2, kNow).refusal, nullptr);
  EXPECT_EQ(admit(reader(1), std::vector{reader(2)}, 2, kNow).refusal, nullptr);
  EXPECT_EQ(admit(reader(1), std::vector<Caller>{}, 1, kNow).refusal, nullptr);
}

TEST(Admission, AnAddressWithHalfOfTheRoomReplacesWhatItForgotItself) {
  const std::vector forgotten{writer(1, 60), reader(2, 900), writer(1, 61), writer(2, 900)};
  EXPECT_EQ(admit(writer(1), forgotten, 4, kNow).instead_of, 2U);
  EXPECT_EQ(admit(writer(1), forgotten, 4, kNow).refusal, nullptr);
  EXPECT_NE(admit(writer(1), std::vector{writer(1, 59), reader(2, 900), writer(1, 59)}, 4, kNow).refusal, nullptr);
  EXPECT_EQ(admit(reader(1), std::vector{reader(1, 70), reader(1, 60)}, 4, kNow).instead_of, 0U);
  EXPECT_NE(admit(reader(1), std::vector{commanding(reader(1)), reader(1, 1)}, 4, kNow).refusal, nullptr);
}

TEST(Admission, AFullServerRefusesWhoMayOnlyRead) {
  EXPECT_NE(admit(reader(9), std::vector{reader(1, 500), reader(2, 500)}, 2, kNow).refusal, nullptr);
}

TEST(Admission, WhoMayWriteTakesThePlaceOfTheMostSilentReader) {
  EXPECT_EQ(admit(writer(9), std::vector{reader(1, 1), writer(2, 900), reader(3, 2)}, 3, kNow).instead_of, 2U);
  EXPECT_EQ(admit(writer(9), std::vector{reader(1, 0), writer(2, 900)}, 2, kNow).instead_of, 0U);
}

TEST(Admission, ElseOfAWriterThatWasSilentForAMinute) {
  EXPECT_EQ(admit(writer(9), std::vector{writer(1, 60), writer(2, 61)}, 2, kNow).instead_of, 1U);
  EXPECT_NE(admit(writer(9), std::vector{writer(1, 59), writer(2, 59)}, 2, kNow).refusal, nullptr);
  EXPECT_EQ(admit(writer(1), std::vector{writer(1, 60)}, 1, kNow).instead_of, 0U);
}

TEST(Admission, WhoseCommandIsUnderWayStays) {
  EXPECT_NE(admit(writer(9), std::vector{commanding(reader(1)), commanding(writer(2))}, 2, kNow).refusal, nullptr);
  EXPECT_EQ(admit(writer(9), std::vector{commanding(reader(1)), writer(2, 60)}, 2, kNow).instead_of, 1U);
}

}  // namespace
