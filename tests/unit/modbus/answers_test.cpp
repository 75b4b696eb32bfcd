#include "bridges/modbus/answers.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>
#include <variant>
#include <vector>

#include "bridges/modbus/mbap.h"
#include "tests/unit/modbus/bytes.h"

namespace {

using modbus::Answers;
using modbus::Exception;
using modbus::Request;
using modbus::Snapshot;
using modbus_test::Bytes;
using modbus_test::frame;

class AnswersTest : public testing::Test {
 protected:
  AnswersTest() {
    std::iota(values_.registers.begin(), values_.registers.end(), std::uint16_t{0x1000});
    for (std::size_t i = 0; i < values_.bits.size(); ++i) {
      values_.bits[i] = i % 3 == 0 ? 1 : 0;
    }
  }

  static Bytes answer_of(Answers& answers, Snapshot& values, const Bytes& request) {
    std::array<std::uint8_t, modbus::kMaxFrame> room{};
    const auto parsed = modbus::parse_request(modbus::pdu_of(request));
    const auto worded = answers.answer(request, std::get<Request>(parsed), values, room);
    return {worded.begin(), worded.end()};
  }
  static Bytes refusal_of(Answers& answers, const Bytes& request, Exception exception) {
    std::array<std::uint8_t, modbus::kMaxFrame> room{};
    const auto worded = answers.refuse(request, exception, room);
    return {worded.begin(), worded.end()};
  }
  Bytes answer_to(std::string_view pdu) { return answer_of(answers_, values_, frame(0, pdu, 0x1234)); }

  Answers answers_;
  Snapshot values_;
};

TEST_F(AnswersTest, ReadsAreAnsweredFromTheSnapshotWhereverTheAddress) {
  EXPECT_EQ(answer_to("03 0000 0002"), frame(0, "03 04 1000 1001", 0x1234));
  EXPECT_EQ(answer_to("04 03e8 0002"), frame(0, "04 04 1000 1001", 0x1234));
  EXPECT_EQ(answer_to("03 ffff 0001"), frame(0, "03 02 1000", 0x1234));
  EXPECT_EQ(answer_to("01 0000 000a"), frame(0, "01 02 4902", 0x1234));
  EXPECT_EQ(answer_to("02 f830 000a"), frame(0, "02 02 4902", 0x1234));
}

TEST_F(AnswersTest, TheLargestReadsFit) {
  const Bytes registers = answer_to("03 0000 007d");
  EXPECT_EQ(registers.size(), 9U + 250U);
  EXPECT_EQ(registers.back(), static_cast<std::uint8_t>(0x1000 + 124));
  EXPECT_EQ(answer_to("01 0000 07d0").size(), 9U + 250U);
}

TEST_F(AnswersTest, WritesAreAnsweredAndTouchNoValue) {
  const Snapshot before = values_;
  EXPECT_EQ(answer_to("06 0065 1388"), frame(0, "06 0065 1388", 0x1234));
  EXPECT_EQ(answer_to("05 ffff ff00"), frame(0, "05 ffff ff00", 0x1234));
  EXPECT_EQ(answer_to("0f 000a 0009 02 ff01"), frame(0, "0f 000a 0009", 0x1234));
  EXPECT_EQ(answer_to("10 fffe 0002 04 00031388"), frame(0, "10 fffe 0002", 0x1234));
  EXPECT_EQ(answer_to("16 0064 fff0 0003"), frame(0, "16 0064 fff0 0003", 0x1234));
  EXPECT_EQ(values_.registers, before.registers);
  EXPECT_EQ(values_.bits, before.bits);
}

TEST_F(AnswersTest, TheLargestWritesAreAnswered) {
  std::string registers = "10 ff00 007b f6";
  for (int i = 0; i < 123; ++i) {
    registers += "beef";
  }
  EXPECT_EQ(answer_to(registers), frame(0, "10 ff00 007b", 0x1234));
  std::string bits = "0f 0000 07b0 f6";
  for (int i = 0; i < 246; ++i) {
    bits += "ff";
  }
  EXPECT_EQ(answer_to(bits), frame(0, "0f 0000 07b0", 0x1234));
}

TEST_F(AnswersTest, Function23ReadsTheSnapshotNotWhatTheRequestBrings) {
  EXPECT_EQ(answer_to("17 0064 0002 0064 0001 02 beef"), frame(0, "17 04 1000 1001", 0x1234));
  EXPECT_EQ(answer_to("17 fffe 0002 0000 0001 02 beef"), frame(0, "17 04 1000 1001", 0x1234));
  std::string largest = "17 0000 007d 0000 0079 f2";
  for (int i = 0; i < 121; ++i) {
    largest += "beef";
  }
  const Bytes answer = answer_to(largest);
  ASSERT_EQ(answer.size(), 9U + 250U);
  EXPECT_EQ(answer.back(), static_cast<std::uint8_t>(0x1000 + 124));
}

TEST_F(AnswersTest, RefusalsCarryTheException) {
  for (const Exception exception : {Exception::illegal_function, Exception::illegal_address, Exception::illegal_value,
                                    Exception::device_failure, Exception::unknown_unit, Exception::no_response}) {
    const Bytes request = frame(9, "2b 0e 01 00", 7);
    Bytes expected = frame(9, "ab 00", 7);
    expected.back() = static_cast<std::uint8_t>(exception);
    EXPECT_EQ(refusal_of(answers_, request, exception), expected);
  }
}

// libmodbus aborts the process where it waits for such a descriptor.
TEST_F(AnswersTest, DescriptorsBeyond1023AreFine) {
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &limit), 0);
  const rlim_t before = limit.rlim_cur;
  limit.rlim_cur = std::max<rlim_t>(before, 2000);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0) << "this machine allows only " << limit.rlim_max << " descriptors";
  std::vector<int> taken;
  while (taken.empty() || taken.back() < 1100) {
    taken.push_back(::dup(0));
    ASSERT_GE(taken.back(), 0);
  }
  {
    Answers high;
    EXPECT_EQ(answer_of(high, values_, frame(0, "03 0000 0001")), frame(0, "03 02 1000"));
    EXPECT_EQ(refusal_of(high, frame(0, "03 0000 0001"), Exception::illegal_value), frame(0, "83 03"));
  }
  std::ranges::for_each(taken, ::close);
  limit.rlim_cur = before;
  EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
}

}  // namespace
