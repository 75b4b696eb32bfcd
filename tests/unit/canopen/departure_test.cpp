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

// A controller that sends by identifier: what it still holds must not leave after a stop.
TEST_F(DepartureTest, AnEchoThatMayHaveOvertakenARepetitionDoesNotFreeItsPlace) {
  see_life();
  Sent repetition;
  push(repetition, TransmitClass::repetition, frame(0x205, 1));
  push(TransmitClass::control, frame(0x080));
  echo(frame(0x080));
  Sent stop;
  push_command(stop, frame(0x205, 0));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x205, 0x080}));
  EXPECT_EQ(repetition.departure, std::nullopt);
  echo(frame(0x205, 1));
  EXPECT_EQ(repetition.departure, Departure::left);
  EXPECT_EQ(link.sent.back(), frame(0x205, 0));
}

TEST_F(DepartureTest, OfAFrameThatIsOverdueAnOvertakingEchoProvesNothing) {
  see_life();
  push(TransmitClass::repetition, frame(0x205, 1));
  for (int i = 0; i < 10; ++i) {
    advance(100ms);
    see_life();
    push(TransmitClass::control, frame(0x080));
    echo(frame(0x080));
  }
  Sent stop;
  push_command(stop, frame(0x205, 0));
  EXPECT_NE(link.sent.back(), frame(0x205, 0));
  push(TransmitClass::control, frame(0x77F));
  echo(frame(0x77F));
  EXPECT_EQ(link.sent.back(), frame(0x205, 0));
}

TEST_F(DepartureTest, AnEchoThatMayHaveOvertakenSdoEndsNoWaitForIt) {
  see_life();
  Sent sdo;
  push(sdo, TransmitClass::sdo, frame(0x601));
  push(TransmitClass::nmt, frame(0x000));
  push(TransmitClass::sdo, frame(0x602));
  echo(frame(0x000));
  EXPECT_EQ(sdo.departure, std::nullopt);
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x601, 0x000}));
  echo(frame(0x601));
  EXPECT_EQ(sdo.departure, Departure::left);
}

TEST_F(DepartureTest, AnEchoOfAHigherIdentifierProvesThatTheRepetitionHasGone) {
  see_life();
  Sent repetition;
  push(repetition, TransmitClass::repetition, frame(0x205, 1));
  push(TransmitClass::control, frame(0x77F));
  push(TransmitClass::command, frame(0x205, 0));
  echo(frame(0x77F));
  EXPECT_EQ(repetition.departure, Departure::unknown);
  EXPECT_EQ(link.sent.back(), frame(0x205, 0));
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

// It would wait in a controller that sends first in first out, and leave whenever that frame does.
TEST_F(DepartureTest, NothingGoesBehindAFrameThatGaveItsPlaceBack) {
  see_life();
  push(TransmitClass::sdo, frame(0x67F));
  const auto wait_among_others = [this](Duration time) {
    for (const TimePoint end = now + time; now < end;) {
      advance(50ms);
      see_life();  // Others go before it.
    }
  };
  wait_among_others(100ms);
  push(TransmitClass::sdo, frame(0x601));
  ASSERT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x67F, 0x601}));
  Sent command;
  push_command(command, frame(0x205));
  EXPECT_TRUE(queue.wants_heartbeat(now)) << "0x601 may go before 0x67F, and proves nothing";
  push(TransmitClass::control, frame(0x77F));
  EXPECT_FALSE(queue.wants_heartbeat(now));
  echo(frame(0x601));
  wait_among_others(800ms);
  EXPECT_EQ(command.departure, Departure::withdrawn);
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x67F, 0x601, 0x77F}));

  Sent next;
  push_command(next, frame(0x205));
  EXPECT_TRUE(queue.wants_heartbeat(now)) << "the one before gave its place back, too";
  push(TransmitClass::control, frame(0x77F));
  echo(frame(0x77F));
  EXPECT_EQ(sent_ids().back(), 0x205U);
}

TEST_F(DepartureTest, ALostEchoDelaysACommandForOneHeartbeat) {
  see_life();
  push(TransmitClass::sdo, frame(0x67F));
  advance(50ms);
  see_life();
  advance(50ms);
  Sent command;
  push_command(command, frame(0x205));
  ASSERT_TRUE(queue.wants_heartbeat(now));
  push(TransmitClass::control, frame(0x77F));
  echo(frame(0x77F));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x67F, 0x77F, 0x205}));
}

TEST_F(DepartureTest, TheLateEchoOfAFrameThatGaveItsPlaceBackIsProofToo) {
  see_life();
  push(TransmitClass::sdo, frame(0x67F));
  advance(50ms);
  see_life();
  advance(50ms);
  Sent command;
  push_command(command, frame(0x205));
  EXPECT_EQ(link.sent.size(), 1U);
  echo(frame(0x67F));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x67F, 0x205}));
}

TEST_F(DepartureTest, WithoutAHeartbeatOfOursALateFrameIsNotWaitedForForEver) {
  TransmitQueue mute(link, {}, false);
  mute.on_bus(true);
  mute.on_received(now);
  const Ticket sdo = mute.push(TransmitClass::sdo, frame(0x67F), now + 1s, {}, now);
  mute.service(now);
  now += 50ms;
  mute.on_received(now);
  const Ticket command = mute.push(TransmitClass::command, frame(0x205), now + 800ms, {}, now);
  mute.service(now);
  now += 49ms;
  mute.service(now);
  EXPECT_EQ(link.sent.size(), 1U);
  now += 1ms;
  mute.service(now);
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
