// Another SDO client asks the node while a request of ours is on its way: nobody can tell whose answer comes then.

#include <memory>
#include <string>
#include <vector>

#include "tests/unit/canopen/sdo_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class SdoForeignTest : public SdoBench {
 protected:
  SdoForeignTest() {
    slave_.set(kStatus, DataType::u16, 3);
    slave_.set(kCommand, DataType::u16, 0);
    slave_.set({0x1000, 0}, DataType::u32, 402);
    slave_.delay_answers(20ms);
  }
  void ask(Bytes request) {
    ASSERT_EQ(other_->send(make_frame(0x605, request)), SendResult::handed_over);
    loop_.settle();
  }
  /// Of an object that ours have nothing to do with.
  void ask() { ask({0x40, 0x17, 0x10, 0, 0, 0, 0, 0}); }
  void write_command_object(std::uint8_t value) { ask({0x2B, 0x30, 0x20, 2, value, 0, 0, 0}); }
  static void expect_told(const Error& error, bool unknown) {
    EXPECT_EQ(error.kind, ErrorKind::timeout);
    EXPECT_EQ(error.outcome_unknown, unknown);
    EXPECT_NE(error.detail.find("another SDO client asked this drive meanwhile"), std::string::npos) << error.detail;
  }

  std::unique_ptr<Link> other_ = wire_.connect();
};

TEST_F(SdoForeignTest, AReadIsTriedAgainOnceTheAnswersAreProvenToBeOver) {
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(5ms);
  ask({0x40, 0x30, 0x20, 3, 0, 0, 0, 0});
  loop_.advance(60ms);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().value(), 3U);
  EXPECT_EQ(slave_.reads(), (std::vector<ObjectAddress>{kStatus, kStatus, ObjectAddress{0x1000, 0}, kStatus}));
}

TEST_F(SdoForeignTest, ASettingIsTriedAgain) {
  const auto writing = write(kStatus, DataType::u16, 9);
  loop_.advance(5ms);
  ask();
  loop_.advance(60ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value()) << to_string(writing.get().error());
  EXPECT_EQ(slave_.writes().size(), 2U);
}

TEST_F(SdoForeignTest, ItUsesUpATry) {
  use({.retries = 0});
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(5ms);
  ask();
  loop_.advance(1ms);
  ASSERT_TRUE(reading.done());
  expect_told(reading.get().error(), false);
}

TEST_F(SdoForeignTest, TheOutcomeOfACommandIsUnknownAtOnce) {
  const auto writing = command(kCommand, 1);
  loop_.advance(5ms);
  write_command_object(7);
  loop_.advance(1ms);
  ASSERT_TRUE(writing.done());
  expect_told(writing.get().error(), true);
  loop_.advance(1s);
  EXPECT_EQ(slave_.writes().size(), 2U) << "ours once, and theirs";
}

TEST_F(SdoForeignTest, AStopIsSentAgainOnce) {
  const auto stopping =
      support::spawn(loop_.executor(), client_->write_stop(kCommand, DataType::u16, 5, Clock::now() + 800ms));
  loop_.advance(5ms);
  ask();
  loop_.advance(100ms);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value()) << to_string(stopping.get().error());
}

TEST_F(SdoForeignTest, TheirWriteOfTheSameObjectConfirmsNoStop) {
  slave_.mute(kCommand);
  const auto confirm = [this] {
    slave_.send(0x585, {0x60, 0x30, 0x20, 2, 0, 0, 0, 0});
    loop_.advance(1ms);
  };
  const auto stopping =
      support::spawn(loop_.executor(), client_->write_stop(kCommand, DataType::u16, 5, Clock::now() + 800ms));
  loop_.advance(5ms);
  write_command_object(7);
  loop_.advance(1ms);
  confirm();  // Of our first.
  confirm();  // Of theirs, which undid it.
  EXPECT_FALSE(stopping.done());
  confirm();
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
}

TEST_F(SdoForeignTest, AStopThatIsDisturbedTwiceIsUnknown) {
  const auto stopping =
      support::spawn(loop_.executor(), client_->write_stop(kCommand, DataType::u16, 5, Clock::now() + 800ms));
  loop_.advance(5ms);
  ask();
  loop_.advance(5ms);
  ask();
  loop_.advance(1ms);
  ASSERT_TRUE(stopping.done());
  expect_told(stopping.get().error(), true);
  EXPECT_EQ(slave_.writes().size(), 2U);
}

TEST_F(SdoForeignTest, WhileNothingOfOursIsUnderWayItChangesNothing) {
  write_command_object(7);
  loop_.advance(1ms);
  closed_ = true;
  const auto writing = command(kCommand, 1);
  loop_.advance(1ms);
  write_command_object(8);  // Ours has not left.
  loop_.advance(30ms);
  closed_ = false;
  loop_.advance(60ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value()) << to_string(writing.get().error());
  EXPECT_TRUE(slave_.reads().empty());
}

}  // namespace
}  // namespace canopen
