#include "bridges/modbus/mbap.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <span>

#include "tests/unit/modbus/bytes.h"

namespace {

using modbus::find_frame;
using modbus::Framing;
using modbus_test::Bytes;
using modbus_test::frame;
using modbus_test::hex;

TEST(Mbap, NeedsEveryByteOfAFrame) {
  const Bytes bytes = frame(5, "03 0000 000d");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(find_frame(std::span(bytes).first(size)).framing, Framing::incomplete) << size;
  }
  EXPECT_EQ(find_frame(bytes).framing, Framing::complete);
  EXPECT_EQ(find_frame(bytes).size, 12U);
}

TEST(Mbap, LeavesWhatFollowsForTheNext) {
  Bytes bytes = frame(5, "03 0000 000d");
  bytes.push_back(0xAA);
  EXPECT_EQ(find_frame(bytes).size, 12U);
}

TEST(Mbap, TellsUnitAndPdu) {
  const Bytes bytes = frame(17, "03 0000 000d");
  EXPECT_EQ(modbus::unit_of(bytes), 17);
  const auto pdu = modbus::pdu_of(bytes);
  EXPECT_EQ(Bytes(pdu.begin(), pdu.end()), hex("03 0000 000d"));
}

TEST(Mbap, AnotherProtocolIsBrokenAsSoonAsItShows) {
  EXPECT_EQ(find_frame(hex("0001 01")).framing, Framing::broken);
  EXPECT_EQ(find_frame(hex("0001 00 01")).framing, Framing::broken);
  EXPECT_EQ(find_frame(hex("474554202f20485454502f312e310d0a")).framing, Framing::broken);  // GET / HTTP/1.1
}

TEST(Mbap, LengthsThatCanNotBeAreBroken) {
  EXPECT_EQ(find_frame(hex("0001 0000 0000")).framing, Framing::broken);
  EXPECT_EQ(find_frame(hex("0001 0000 0001")).framing, Framing::broken);  // a unit without a function
  EXPECT_EQ(find_frame(hex("0001 0000 0002")).framing, Framing::incomplete);
  EXPECT_EQ(find_frame(hex("0001 0000 00fe")).framing, Framing::incomplete);
  EXPECT_EQ(find_frame(hex("0001 0000 00ff")).framing, Framing::broken);
  EXPECT_EQ(find_frame(hex("0001 0000 ffff")).framing, Framing::broken);
}

TEST(Mbap, AnyFunctionMakesAFrame) {
  for (const char* const pdu : {"00", "7f", "80", "90 01", "ff"}) {
    EXPECT_EQ(find_frame(frame(5, pdu)).framing, Framing::complete) << pdu;
  }
}

TEST(Mbap, AnAnswerHasTheHeaderOfItsRequest) {
  const Bytes request = frame(17, "2b 0e 01 00", 0xBEEF);
  std::array<std::uint8_t, modbus::kMaxFrame> out{};
  const Bytes longest(modbus::kMaxPdu, 0x2B);
  for (const Bytes& pdu : {hex("ab 01"), longest}) {
    const auto answer = modbus::frame_answer(request, pdu, out);
    Bytes expected = hex(pdu.size() == 2 ? "beef 0000 0003 11" : "beef 0000 00fe 11");
    expected.insert(expected.end(), pdu.begin(), pdu.end());
    EXPECT_EQ(Bytes(answer.begin(), answer.end()), expected);
  }
}

}  // namespace
