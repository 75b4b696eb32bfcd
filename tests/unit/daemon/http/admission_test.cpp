#include "daemon/http/admission.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

namespace gateway::http {
namespace {

using boost::asio::ip::make_address;

const canopen::TimePoint kStart = canopen::TimePoint{} + std::chrono::hours(1);

Guest idle(int host, int silent) {
  return {make_address("192.0.2." + std::to_string(host)), kStart - std::chrono::seconds(silent)};
}
Guest busy(int host) {
  return {make_address("192.0.2." + std::to_string(host)), std::nullopt};
}

TEST(HttpAdmission, WhereThereIsRoomNobodyLeaves) {
  const Admission admission = admit(make_address("192.0.2.9"), std::vector{idle(1, 60), busy(2)}, 4);
  EXPECT_EQ(admission.refusal, nullptr);
  EXPECT_FALSE(admission.instead_of);
}

TEST(HttpAdmission, TheLongestIdleMakesRoom) {
  const std::vector guests{idle(1, 1), idle(2, 3), busy(3), idle(4, 2)};
  EXPECT_EQ(admit(make_address("192.0.2.9"), guests, 4).instead_of, 1U);
  EXPECT_EQ(admit(make_address("192.0.2.9"), guests, 4).refusal, nullptr);
  EXPECT_NE(admit(make_address("192.0.2.9"), std::vector{busy(1), busy(2)}, 2).refusal, nullptr);
}

TEST(HttpAdmission, AnAddressWithHalfOfTheRoomReplacesItsOwn) {
  const std::vector guests{idle(2, 900), idle(1, 1), idle(1, 2)};
  EXPECT_EQ(admit(make_address("192.0.2.1"), guests, 4).instead_of, 2U);
  EXPECT_NE(admit(make_address("192.0.2.1"), std::vector{idle(2, 900), busy(1), busy(1)}, 4).refusal, nullptr);
  EXPECT_EQ(admit(make_address("192.0.2.1"), std::vector<Guest>{}, 1).refusal, nullptr);
}

}  // namespace
}  // namespace gateway::http
