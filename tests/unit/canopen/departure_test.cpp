#include <gtest/gtest.h>

#include <vector>

#include "canopen/bus/transmit_queue.h"
#include "tests/support/transmit_queue_fixture.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;

class DepartureTest : public support::TransmitQueueFixture {};

TEST_F(DepartureTest, ACommandLeavesWithItsEcho) {
  see_life();
  Sent command;
  push_command(command, frame(0x205));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x205}));
  EXPECT_EQ(command.departure, std::nullopt);
  now += 3ms;
  echo(frame(0x205));
  EXPECT_EQ(command.departure, Departure::left);
}

TEST_F(DepartureTest, OnlyOneCommandIsInTheKernel) {
  see_life();
  Sent first;
  Sent second;
  push_command(first, frame(0x205));
  push_command(second, frame(0x201));
  push(TransmitClass::sdo, frame(0x601));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x205, 0x601})) << "others go on beside it";
  echo(frame(0x205));
  EXPECT_EQ(sent_ids().back(), 0x201U);
}

TEST_F(DepartureTest, OnASilentBusACommandWaitsForASignOfLife) {
  Sent command;
  push_command(command, frame(0x000));
  EXPECT_TRUE(link.sent.empty());
  EXPECT_TRUE(queue.wants_heartbeat(now));
  push(TransmitClass::control, frame(0x77F));
  EXPECT_FALSE(queue.wants_heartbeat(now)) << "our own frame may bring it";
  now += 1ms;
  echo(frame(0x77F));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x77F, 0x000}));
}

TEST_F(DepartureTest, ASignOfLifeIsGoodForASecond) {
  see_life();
  advance(1s);
  Sent in_time;
  push_command(in_time, frame(0x205));
  EXPECT_EQ(link.sent.size(), 1U);
  echo(frame(0x205));
  advance(1001ms);
  Sent late;
  push_command(late, frame(0x205));
  EXPECT_EQ(link.sent.size(), 1U);
}

TEST_F(DepartureTest, AnExpiredCommandNeverLeaves) {
  Sent command;
  push_command(command, frame(0x205), 800ms);
  advance(799ms);
  EXPECT_EQ(command.departure, std::nullopt);
  advance(1ms);
  EXPECT_EQ(command.departure, Departure::withdrawn);
  advance(1h);
  see_life();
  echo(frame(0x77F));
  EXPECT_TRUE(link.sent.empty());
}

TEST_F(DepartureTest, ACommandBornTooLateIsWithdrawn) {
  see_life();
  Sent command;
  push_command(command, frame(0x205), 0ms);
  EXPECT_EQ(command.departure, Departure::withdrawn);
  EXPECT_TRUE(link.sent.empty());
}

TEST_F(DepartureTest, WithoutEchoTheOutcomeIsUnknownAndNoCommandIsTaken) {
  see_life();
  Sent lost;
  Sent waiting;
  push_command(lost, frame(0x205));
  push_command(waiting, frame(0x206));
  advance(99ms);
  EXPECT_EQ(lost.departure, std::nullopt);
  advance(1ms);
  EXPECT_EQ(lost.departure, Departure::unknown);
  EXPECT_EQ(waiting.departure, Departure::offline);

  see_life();  // Receiving does not prove that we can send.
  Sent refused;
  push_command(refused, frame(0x206));
  EXPECT_EQ(refused.departure, Departure::offline);

  push(TransmitClass::control, frame(0x77F));
  now += 1ms;
  echo(frame(0x77F));
  Sent taken;
  push_command(taken, frame(0x206));
  EXPECT_EQ(sent_ids().back(), 0x206U);
}

TEST_F(DepartureTest, ALateEchoEndsTheRefusalToo) {
  see_life();
  Sent lost;
  push_command(lost, frame(0x205));
  advance(5s);
  EXPECT_EQ(lost.departure, Departure::unknown);
  echo(frame(0x205));
  Sent next;
  push_command(next, frame(0x205));
  EXPECT_EQ(link.sent.size(), 2U);
  echo(frame(0x205));
  EXPECT_EQ(next.departure, Departure::left);
}

TEST_F(DepartureTest, ByItsDeadlineTheOutcomeIsUnknownButOthersMayWait) {
  see_life();
  Sent hurried;
  Sent waiting;
  push_command(hurried, frame(0x205), 5ms);
  push_command(waiting, frame(0x206));
  advance(5ms);
  EXPECT_EQ(hurried.departure, Departure::unknown);
  EXPECT_EQ(waiting.departure, std::nullopt) << "the bus may just be loaded";
  echo(frame(0x205));
  EXPECT_EQ(sent_ids().back(), 0x206U);
}

TEST_F(DepartureTest, ALostEchoShiftsNoLaterOne) {
  see_life();
  Sent first;
  push_command(first, frame(0x205, 1));
  // Its echo is lost in an overrun; a frame that was handed over later comes back.
  push(TransmitClass::sdo, frame(0x601));
  now += 1ms;
  echo(frame(0x601));
  advance(100ms);
  EXPECT_EQ(first.departure, Departure::unknown);
  for (int i = 0; i < 10; ++i) {
    see_life();
    Sent same;
    push_command(same, frame(0x205, 1));
    now += 1ms;
    echo(frame(0x205, 1));
    ASSERT_EQ(same.departure, Departure::left) << i;
  }
}

TEST_F(DepartureTest, ALostEchoOfTheFrameBeforeShiftsNoLaterOne) {
  see_life();
  push(TransmitClass::sdo, frame(0x601));
  Sent command;
  push_command(command, frame(0x205));
  advance(100ms);
  EXPECT_EQ(command.departure, Departure::unknown);
  // The cable is back: the first frame leaves, the command's echo follows at once or never.
  echo(frame(0x601));
  Sent early;
  push_command(early, frame(0x205));
  EXPECT_EQ(early.departure, Departure::offline) << "its echo could be taken for the one of the first";
  advance(100ms);
  see_life();
  Sent same;
  push_command(same, frame(0x205));
  now += 1ms;
  echo(frame(0x205));
  EXPECT_EQ(same.departure, Departure::left);
}

TEST_F(DepartureTest, SwappedEchoesOfTwoMailboxesConfirmBoth) {
  see_life();
  Sent command;
  push_command(command, frame(0x205));
  push(TransmitClass::control, frame(0x080));
  echo(frame(0x080));
  EXPECT_EQ(command.departure, std::nullopt);
  echo(frame(0x205));
  EXPECT_EQ(command.departure, Departure::left);
}

TEST_F(DepartureTest, AForeignEchoConfirmsNothing) {
  see_life();
  Sent command;
  push_command(command, frame(0x205, 1));
  echo(frame(0x205, 2));
  EXPECT_EQ(command.departure, std::nullopt);
}

TEST_F(DepartureTest, WhenTheBusGoesDownCommandsAreAnsweredAtOnce) {
  see_life();
  Sent in_kernel;
  Sent waiting;
  push_command(in_kernel, frame(0x205));
  push_command(waiting, frame(0x206));
  queue.on_bus(false);
  EXPECT_EQ(in_kernel.departure, Departure::unknown);
  EXPECT_EQ(waiting.departure, Departure::offline);
  Sent refused;
  push_command(refused, frame(0x207));
  EXPECT_EQ(refused.departure, Departure::offline);
  EXPECT_EQ(push(TransmitClass::sdo, frame(0x601)).departure, Departure::offline);

  // The controller may still hold the first: commands wait until a later frame came back.
  queue.on_bus(true);
  see_life();
  Sent early;
  push_command(early, frame(0x205));
  EXPECT_EQ(early.departure, Departure::offline);
  push(TransmitClass::control, frame(0x77F));
  echo(frame(0x77F));
  Sent next;
  push_command(next, frame(0x205));
  echo(frame(0x205));
  EXPECT_EQ(next.departure, Departure::left);
}

TEST_F(DepartureTest, NothingGoesBehindAFrameThatIsStuck) {
  see_life();
  push(TransmitClass::control, frame(0x77F));
  advance(21ms);
  see_life();
  Sent command;
  push_command(command, frame(0x205));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x77F}));
  echo(frame(0x77F));
  EXPECT_EQ(sent_ids().back(), 0x205U);
}

TEST_F(DepartureTest, ACommandDoesNotWaitForAFrameThatIsOnlyBusy) {
  see_life();
  push(TransmitClass::sdo, frame(0x601));
  advance(20ms);
  Sent command;
  push_command(command, frame(0x205));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x601, 0x205}));
}

TEST_F(DepartureTest, AFrameThatCannotWinTheBusDelaysACommandForAMoment) {
  see_life();
  push(TransmitClass::sdo, frame(0x67F));
  advance(30ms);
  see_life();  // Others go before it.
  Sent command;
  push_command(command, frame(0x205));
  EXPECT_EQ(link.sent.size(), 1U);
  advance(69ms);
  EXPECT_EQ(link.sent.size(), 1U);
  see_life();
  advance(1ms);
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x67F, 0x205}));
}

TEST_F(DepartureTest, OurHeartbeatIsAskedForWhatBecameOfACommand) {
  see_life();
  Sent command;
  push_command(command, frame(0x205));
  see_life();
  advance(99ms);
  see_life();
  EXPECT_FALSE(queue.wants_heartbeat(now));
  advance(1ms);
  EXPECT_EQ(command.departure, Departure::unknown);
  EXPECT_TRUE(queue.wants_heartbeat(now));
  push(TransmitClass::control, frame(0x77F));
  EXPECT_FALSE(queue.wants_heartbeat(now)) << "it is on its way";
  advance(500ms);
  see_life();
  EXPECT_FALSE(queue.wants_heartbeat(now)) << "once is enough: the next one comes by itself";
}

}  // namespace
}  // namespace canopen
