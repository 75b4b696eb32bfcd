#include "simulator/misbehave.h"

#include <gtest/gtest.h>

#include "simulator/pdo_settings.h"
#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

constexpr std::uint8_t kUnruly = 6;
constexpr std::uint32_t kAnswer = 0x580U + kUnruly;

class MisbehaveTest : public ::testing::Test {
 protected:
  MisbehaveTest() : bench("vacon-opte6", kUnruly, with_heartbeat()) {}
  static DriveOptions with_heartbeat() {
    DriveOptions options;
    options.heartbeat_ms = 100;
    return options;
  }
  std::optional<canopen::Frame> read_device_type() { return bench.sdo(kUnruly, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}); }
  void map_control_word() {
    constexpr std::uint32_t kRpdo1 = 0x200U + kUnruly;
    ASSERT_EQ(bench.write(kUnruly, 0x1400, 1, kPdoDisabled | kRpdo1, 4), 0U);
    ASSERT_EQ(bench.write(kUnruly, 0x1600, 0, 0, 1), 0U);
    ASSERT_EQ(bench.write(kUnruly, 0x1600, 1, map_value(0x6040, 0, 16), 4), 0U);
    ASSERT_EQ(bench.write(kUnruly, 0x1600, 0, 1, 1), 0U);
    ASSERT_EQ(bench.write(kUnruly, 0x1400, 1, kRpdo1, 4), 0U);
  }
  Misbehaviour& misbehave() { return bench.drive().misbehaviour(); }

  OneDrive bench;
};

TEST_F(MisbehaveTest, MuteSendsNothingAndHears) {
  misbehave().mute = true;
  bench.start();
  bench.advance(seconds(1));
  EXPECT_FALSE(read_device_type().has_value());
  EXPECT_TRUE(bench.heard.empty());
  EXPECT_EQ(bench.drive().state(), NmtState::operational);
  misbehave().mute = false;
  bench.advance(milliseconds(100));
  EXPECT_EQ(bench.heard.size(), 1U);
}

TEST_F(MisbehaveTest, UnpluggedHearsNothingEither) {
  misbehave().unplugged = true;
  bench.start();
  bench.advance(seconds(1));
  EXPECT_TRUE(bench.heard.empty());
  EXPECT_EQ(bench.drive().state(), NmtState::pre_operational);
}

TEST_F(MisbehaveTest, HeartbeatsStopAloneAndBootUpsGoMissing) {
  misbehave().heartbeat_stopped = true;
  bench.advance(seconds(1));
  EXPECT_TRUE(bench.heard.empty());
  EXPECT_TRUE(read_device_type().has_value());
  misbehave().boot_up_missing = true;
  bench.nmt(0x81, kUnruly);
  EXPECT_TRUE(bench.heard.empty());
}

TEST_F(MisbehaveTest, SlowAnswersComeLateAndInOrder) {
  misbehave().sdo_delay = milliseconds(200);
  EXPECT_FALSE(read_device_type().has_value());
  bench.advance(milliseconds(100));
  bench.send(0x606, {0x40, 0x18, 0x10, 1, 0, 0, 0, 0});
  bench.advance(milliseconds(99));
  EXPECT_TRUE(bench.take(kAnswer).empty());
  bench.advance(milliseconds(1));
  auto answers = bench.take(kAnswer);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].data[2], 0x10);
  EXPECT_EQ(answers[0].data[1], 0x00);
  bench.advance(milliseconds(100));
  answers = bench.take(kAnswer);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].data[1], 0x18);
}

TEST_F(MisbehaveTest, LateAnswersDieWithTheDrive) {
  misbehave().sdo_delay = milliseconds(200);
  EXPECT_FALSE(read_device_type().has_value());
  bench.nmt(0x82, kUnruly);
  bench.advance(seconds(1));
  EXPECT_TRUE(bench.take(kAnswer).empty());
}

TEST_F(MisbehaveTest, ASlowDriveHoldsABoundedNumberOfAnswers) {
  misbehave().sdo_delay = seconds(1);
  for (int i = 0; i < 200; ++i) {
    bench.send(0x606, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  }
  bench.advance(seconds(2));
  EXPECT_EQ(bench.take(kAnswer).size(), 64U);
}

TEST_F(MisbehaveTest, NoLateAnswerInStopped) {
  misbehave().sdo_delay = milliseconds(200);
  EXPECT_FALSE(read_device_type().has_value());
  bench.nmt(0x02, kUnruly);
  bench.advance(seconds(1));
  EXPECT_TRUE(bench.take(kAnswer).empty());
}

TEST_F(MisbehaveTest, DropsTheNextRequests) {
  misbehave().sdo_drops_left = 2;
  EXPECT_FALSE(read_device_type().has_value());
  EXPECT_FALSE(read_device_type().has_value());
  EXPECT_TRUE(read_device_type().has_value());
  EXPECT_EQ(bench.drive().record().sdo_reads.at({0x1000, 0}), 1U);
}

TEST_F(MisbehaveTest, ForeignAnswers) {
  misbehave().sdo_flaw = SdoFlaw::foreign_index;
  EXPECT_EQ(read_device_type(), frame(kAnswer, {0x43, 0x01, 0x10, 0, 0x92, 0x01, 0x01, 0x00}));
  misbehave().sdo_flaw = SdoFlaw::foreign_sub_index;
  EXPECT_EQ(read_device_type(), frame(kAnswer, {0x43, 0x00, 0x10, 1, 0x92, 0x01, 0x01, 0x00}));
  misbehave().sdo_flaw = SdoFlaw::unknown_command;
  EXPECT_EQ(read_device_type()->data[0], 0xE0);
}

TEST_F(MisbehaveTest, FlawsCanBeCounted) {
  misbehave().sdo_flaw = SdoFlaw::abort;
  misbehave().abort_code = 0x08000022;
  misbehave().flaws_left = 1;
  EXPECT_EQ(read_device_type(), frame(kAnswer, {0x80, 0x00, 0x10, 0, 0x22, 0x00, 0x00, 0x08}));
  EXPECT_EQ(read_device_type()->data[0], 0x43);
  EXPECT_EQ(misbehave().flaws_left, 0U);
}

TEST_F(MisbehaveTest, WrongToggleMeetsSegmentsOnly) {
  misbehave().sdo_flaw = SdoFlaw::wrong_toggle;
  EXPECT_EQ(bench.sdo(kUnruly, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0})->data[0], 0x41);
  EXPECT_EQ(bench.sdo(kUnruly, {0x60, 0, 0, 0, 0, 0, 0, 0})->data[0], 0x10);
}

TEST_F(MisbehaveTest, AnswersCutShort) {
  misbehave().sdo_short = true;
  EXPECT_EQ(bench.sdo(kUnruly, {0x40, 0x17, 0x10, 0, 0, 0, 0, 0}), frame(kAnswer, {0x4B, 0x17, 0x10, 0, 100, 0}));
  EXPECT_EQ(bench.sdo(kUnruly, {0x2B, 0x17, 0x10, 0, 100, 0, 0, 0}), frame(kAnswer, {0x60, 0x17, 0x10, 0}));
  EXPECT_EQ(bench.sdo(kUnruly, {0x40, 0x34, 0x12, 0, 0, 0, 0, 0})->size, 8);
}

TEST_F(MisbehaveTest, FramesOfAWrongLength) {
  misbehave().sdo_length = 3;
  EXPECT_EQ(read_device_type(), frame(kAnswer, {0x43, 0x00, 0x10}));
  misbehave() = {};
  misbehave().heartbeat_length = 0;
  bench.advance(milliseconds(100));
  EXPECT_EQ(bench.take(0x706).back(), frame(0x706, {}));
  misbehave().emcy_length = 2;
  bench.drive().fault(1);
  bench.loop.settle();
  EXPECT_EQ(bench.take(0x086), std::vector{frame(0x086, {0x00, 0x10})});
}

TEST_F(MisbehaveTest, TpdosOfAWrongLength) {
  OneDrive veichi("veichi-ac300", kUnruly);
  veichi.drive().misbehaviour().tpdo_length = 5;
  veichi.start();
  EXPECT_EQ(veichi.last(0x186)->size, 5);
  veichi.drive().misbehaviour().tpdo_length = 8;
  veichi.advance(milliseconds(200));
  EXPECT_EQ(veichi.last(0x286)->size, 8);
}

TEST_F(MisbehaveTest, RefusesSdoToWhatAnRpdoCarriesAndNothingElse) {
  misbehave().pdo_only = 0x06010002;
  EXPECT_EQ(bench.write(kUnruly, 0x6040, 0, 6, 2), 0U) << "no RPDO carries it yet";
  map_control_word();
  EXPECT_EQ(bench.write(kUnruly, 0x6040, 0, 7, 2), 0x06010002U);
  EXPECT_EQ(bench.read(kUnruly, 0x6040, 0), 6U);
  EXPECT_EQ(bench.write(kUnruly, 0x6042, 0, 500, 2), 0U);
  bench.start();
  bench.send(0x200U + kUnruly, {7, 0});
  EXPECT_EQ(bench.read(kUnruly, 0x6040, 0), 7U);
}

TEST_F(MisbehaveTest, UnderLocalControlTheBusMovesNothing) {
  map_control_word();
  bench.start();
  misbehave().local = true;
  bench.send(0x200U + kUnruly, {6, 0});
  EXPECT_EQ(bench.read(kUnruly, 0x6040, 0), 0U);
  EXPECT_EQ(bench.drive().record().rpdo_total(), 1U);
  EXPECT_EQ(bench.write(kUnruly, 0x6040, 0, 6, 2), 0x08000021U);
  EXPECT_EQ(*bench.read(kUnruly, 0x6041, 0) & 0x0200U, 0U) << "remote";
  misbehave().local = false;
  EXPECT_EQ(*bench.read(kUnruly, 0x6041, 0) & 0x0200U, 0x0200U);
  bench.send(0x200U + kUnruly, {6, 0});
  EXPECT_EQ(bench.read(kUnruly, 0x6040, 0), 6U);
}

TEST_F(MisbehaveTest, DeniesAnObjectOrASubIndexOfIt) {
  ASSERT_TRUE(bench.read(kUnruly, 0x6042, 0));
  misbehave().absent = {{0x6042, {}}, {0x1018, std::uint8_t{2}}};
  EXPECT_EQ(bench.sdo(kUnruly, {0x40, 0x42, 0x60, 0, 0, 0, 0, 0}),
            frame(kAnswer, {0x80, 0x42, 0x60, 0, 0x00, 0x00, 0x02, 0x06}));
  EXPECT_EQ(bench.write(kUnruly, 0x6042, 0, 500, 2), 0x06020000U);
  EXPECT_EQ(bench.sdo(kUnruly, {0x40, 0x18, 0x10, 2, 0, 0, 0, 0}),
            frame(kAnswer, {0x80, 0x18, 0x10, 2, 0x11, 0x00, 0x09, 0x06}));
  EXPECT_TRUE(bench.read(kUnruly, 0x1018, 1));
  misbehave() = {};
  EXPECT_TRUE(bench.read(kUnruly, 0x6042, 0));
}

TEST_F(MisbehaveTest, EmergenciesAreStoredAsOff) {
  misbehave().emcy_id = 0x80000086;
  bench.drive().power_off();
  bench.drive().power_on();
  bench.loop.settle();
  static_cast<void>(bench.take(0x086));
  EXPECT_EQ(bench.read(kUnruly, 0x1014, 0), 0x80000086U);
  bench.drive().fault(1);
  bench.loop.settle();
  EXPECT_TRUE(bench.take(0x086).empty());
  EXPECT_EQ(bench.write(kUnruly, 0x1014, 0, 0x86, 4), 0U);
  bench.drive().fault(2);
  bench.loop.settle();
  EXPECT_FALSE(bench.take(0x086).empty());
}

}  // namespace
}  // namespace simulator
