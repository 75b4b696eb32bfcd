// What an SDO client makes of the answers of a node, the odd ones included.

#include <string>
#include <vector>

#include "tests/unit/canopen/sdo_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class SdoAnswersTest : public SdoBench {};

TEST_F(SdoAnswersTest, ReadsAndWritesEveryType) {
  const std::vector<std::pair<DataType, Raw>> values{
      {DataType::boolean, 1},
      {DataType::u8, 0xFE},
      {DataType::i16, static_cast<Raw>(-2)},
      {DataType::u32, 0xDEADBEEF},
      {DataType::i64, static_cast<Raw>(-5'000'000'000)},
      {DataType::f64, 0x400921FB54442D18},
  };
  for (const auto& [type, raw] : values) {
    slave_.set(kStatus, type, 0);
    const auto writing = write(kStatus, type, raw);
    loop_.advance(5ms);
    ASSERT_TRUE(writing.done());
    ASSERT_TRUE(writing.get().has_value()) << to_string(writing.get().error());
    EXPECT_EQ(read_now(kStatus, type).value(), raw) << name_of(type);
  }
}

TEST_F(SdoAnswersTest, RequestsHaveEightBytes) {
  slave_.set(kCommand, DataType::u16, 0);
  static_cast<void>(read_now(kCommand, DataType::u16));
  static_cast<void>(command_now(kCommand, 0x1234));
  const std::vector<Frame> heard = slave_.heard_on(0x605);
  ASSERT_EQ(heard.size(), 2U);
  EXPECT_EQ(heard[0], make_frame(0x605, Bytes{0x40, 0x30, 0x20, 0x02, 0, 0, 0, 0}));
  EXPECT_EQ(heard[1], make_frame(0x605, Bytes{0x2B, 0x30, 0x20, 0x02, 0x34, 0x12, 0, 0}));
}

TEST_F(SdoAnswersTest, AbortCarriesNodeObjectAndCode) {
  const Result<Raw> result = read_now(kStatus, DataType::u16);
  ASSERT_TRUE(result.has_error());
  EXPECT_EQ(result.error().kind, ErrorKind::refused);
  EXPECT_EQ(result.error().node, kSdoNode);
  EXPECT_EQ(result.error().object, kStatus);
  EXPECT_EQ(result.error().abort, 0x06020000U);
}

TEST_F(SdoAnswersTest, ShortAbortIsAnAbortWithoutCode) {
  use({});
  answer_with({{0x80, 0x30, 0x20, 0x03}});
  const Result<Raw> result = read_now(kStatus, DataType::u16);
  ASSERT_TRUE(result.has_error());
  EXPECT_EQ(result.error().kind, ErrorKind::refused);
  EXPECT_EQ(result.error().abort, 0U);
  EXPECT_EQ(result.error().detail, "abort, code missing");
  EXPECT_EQ(aborts_, std::vector<std::uint32_t>{0});
}

TEST_F(SdoAnswersTest, FourByteAnswerForA16BitObjectGivesItsLowerBytes) {
  answer_with({{0x43, 0x01, 0x18, 0x03, 0xE8, 0x03, 0xAA, 0xBB}});
  EXPECT_EQ(read_now({0x1801, 3}, DataType::u16).value(), 1000U);
}

TEST_F(SdoAnswersTest, WithoutSizeBitTheTypeDecides) {
  answer_with({{0x42, 0x30, 0x20, 0x03, 0xFE, 0xFF, 0x55, 0x55}});
  EXPECT_EQ(read_now(kStatus, DataType::i16).value(), static_cast<Raw>(-2));
}

TEST_F(SdoAnswersTest, FewerBytesThanTheTypeAreNoValue) {
  answer_with({{0x4F, 0x30, 0x20, 0x03, 0x12, 0, 0, 0}});
  const Result<Raw> result = read_now(kStatus, DataType::u16);
  ASSERT_TRUE(result.has_error());
  EXPECT_EQ(result.error().kind, ErrorKind::protocol);
}

TEST_F(SdoAnswersTest, ShortAnswersOnlyWhereTheProfileAllowsThem) {
  answer_with({{0x4B, 0x30, 0x20, 0x03, 0xDC, 0x00}});
  EXPECT_EQ(read_now(kStatus, DataType::u16).error().kind, ErrorKind::protocol);
  use({.accept_short_answers = true});
  EXPECT_EQ(read_now(kStatus, DataType::u16).value(), 220U);
  answer_with({{0x60, 0x30, 0x20, 0x02}});
  EXPECT_TRUE(command_now(kCommand, 5).has_value());
  answer_with({{0x43, 0x30, 0x20, 0x03, 0xDC, 0x00}});
  EXPECT_EQ(read_now(kStatus, DataType::u16).error().kind, ErrorKind::protocol);
}

TEST_F(SdoAnswersTest, UploadStyleConfirmationOnlyWhereTheProfileAllowsIt) {
  answer_with({{0x4B, 0x30, 0x20, 0x02, 0x05, 0, 0, 0}});
  const Result<void> refused = command_now(kCommand, 5);
  ASSERT_TRUE(refused.has_error());
  EXPECT_EQ(refused.error().kind, ErrorKind::protocol);
  EXPECT_TRUE(refused.error().outcome_unknown);
  use({.accept_upload_style_write_answer = true});
  EXPECT_TRUE(command_now(kCommand, 5).has_value());
  EXPECT_TRUE(remarks_.empty());
  EXPECT_TRUE(command_now(kCommand, 6).has_value());
  EXPECT_EQ(remarks_.size(), 1U);
}

TEST_F(SdoAnswersTest, SegmentedUploadWithAndWithoutSize) {
  const std::string name = "AC310 frequency inverter";
  slave_.set_bytes(kName, Bytes(name.begin(), name.end()));
  EXPECT_EQ(read_now(kName, DataType::u64).value(), 0x7266203031334341U) << "the lower bytes count";
  EXPECT_EQ(slave_.heard_on(0x605).size(), 5U) << "all of it was fetched";

  answer_with({{0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0}, {0x0D, 'A', 0, 0, 0, 0, 0, 0}});
  EXPECT_EQ(read_now(kName, DataType::u8).value(), Raw{'A'});
}

TEST_F(SdoAnswersTest, TheAnnouncedSizeOfAnUploadIsAHint) {
  for (const unsigned announced : {0U, 4U, 6U, 200U}) {
    answer_with({{0x41, 0x30, 0x20, 0x03, static_cast<std::uint8_t>(announced), 0, 0, 0}, {0x05, 1, 2, 3, 4, 5, 0, 0}});
    EXPECT_EQ(read_now(kStatus, DataType::u32).value(), 0x04030201U) << announced;
  }
}

TEST_F(SdoAnswersTest, WrongToggleIsAborted) {
  answer_with({{0x41, 0x08, 0x10, 0x00, 10, 0, 0, 0}, {0x10, 1, 2, 3, 4, 5, 6, 7}});
  const auto reading = read(kName, DataType::u64);
  loop_.advance(5ms);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::protocol);
  EXPECT_EQ(slave_.heard().back(), make_frame(0x605, Bytes{0x80, 0x08, 0x10, 0x00, 0x00, 0x00, 0x03, 0x05}));
}

TEST_F(SdoAnswersTest, EndlessOrOverlongUploadsEnd) {
  answer_with({{0x41, 0x08, 0x10, 0x00, 0, 0, 1, 0}});
  auto reading = read(kName, DataType::u64);
  loop_.advance(5ms);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::protocol);

  slave_.script([](const Bytes& request) {
    const auto toggle = static_cast<std::uint8_t>(request[0] & 0x10U);
    return request[0] == 0x40 ? Answers{{0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0}} : Answers{{toggle, 1, 2, 3, 4, 5, 6, 7}};
  });
  reading = read(kName, DataType::u64);
  loop_.advance(5ms);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::protocol);

  slave_.script([](const Bytes& request) {
    return request[0] == 0x40 ? Answers{{0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0}} : Answers{{0x0E, 0, 0, 0, 0, 0, 0, 0}};
  });
  reading = read(kName, DataType::u64);
  loop_.advance(5ms);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::protocol);
}

}  // namespace
}  // namespace canopen
