#include "canopen/sdo/second_answer.h"

#include <gtest/gtest.h>

#include <vector>

namespace canopen {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Verdict = SecondAnswer::Verdict;

const Bytes kSerial{0x43, 0x18, 0x10, 4, 1, 0, 0, 0};
const Bytes kOtherSerial{0x43, 0x18, 0x10, 4, 2, 0, 0, 0};
const Bytes kAbort{0x80, 0x18, 0x10, 4, 0x11, 0, 9, 6};

TEST(SecondAnswer, OfTheSameObjectIsTheSameOrAnotherOne) {
  SecondAnswer second;
  EXPECT_EQ(second.judge(kSerial), Verdict::none) << "nobody asked";
  second.on_answered(kSerial);
  EXPECT_EQ(second.judge(kSerial), Verdict::further);
  EXPECT_EQ(second.judge(kOtherSerial), Verdict::different);
  EXPECT_EQ(second.judge(kAbort), Verdict::different) << "one has the object, the other has not";
  EXPECT_EQ(second.judge({}), Verdict::none);
}

TEST(SecondAnswer, OfAValueThatMayChangeProvesNothing) {
  SecondAnswer second;
  second.on_answered(Bytes{0x4B, 0x44, 0x60, 0, 1, 0, 0, 0});
  EXPECT_EQ(second.judge(Bytes{0x4B, 0x44, 0x60, 0, 2, 0, 0, 0}), Verdict::further)
      << "CAN may have doubled the request";
}

TEST(SecondAnswer, OfAnotherObjectOrKindMayBeAnythingElse) {
  SecondAnswer second;
  second.on_answered(kSerial);
  EXPECT_EQ(second.judge(Bytes{0x43, 0x18, 0x10, 3, 1, 0, 0, 0}), Verdict::none);
  EXPECT_EQ(second.judge(Bytes{0x01, 0x18, 0x10, 4, 1, 0, 0, 0}), Verdict::none) << "a segment names no object";
  EXPECT_EQ(second.judge(Bytes{0x43, 0x18}), Verdict::none);
}

TEST(SecondAnswer, IsForgottenWhenSomebodyAsksAgain) {
  SecondAnswer second;
  second.on_answered(kSerial);
  second.on_request({0x1018, 3});
  EXPECT_EQ(second.judge(kOtherSerial), Verdict::different);
  second.on_request({0x1018, 4});
  EXPECT_EQ(second.judge(kOtherSerial), Verdict::none);
  second.on_answered(kSerial);
  second.forget();
  EXPECT_EQ(second.judge(kOtherSerial), Verdict::none);
  second.on_answered(kSerial);
  second.on_answered(Bytes{0x00, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(second.judge(kSerial), Verdict::none) << "an answer without an object was the newest";
}

}  // namespace
}  // namespace canopen
