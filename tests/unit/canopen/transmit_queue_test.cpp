// The order in which frames leave, how many the kernel has, and what happens where it takes none.

#include "canopen/bus/transmit_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/support/transmit_queue_fixture.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;

class TransmitQueueTest : public support::TransmitQueueFixture {};

TEST_F(TransmitQueueTest, ClassesGoBeforeIdentifiers) {
  link.result = SendResult::busy;
  push(TransmitClass::sdo, frame(0x601));
  push(TransmitClass::repetition, frame(0x201));
  push(TransmitClass::command, frame(0x605));
  push(TransmitClass::command, frame(0x305));
  push(TransmitClass::control, frame(0x77F));
  push(TransmitClass::control, frame(0x080));
  push(TransmitClass::nmt, frame(0x000));
  link.result = SendResult::handed_over;
  see_life();
  advance(2ms);
  drain();
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x000, 0x080, 0x77F, 0x601, 0x305, 0x605, 0x201}))
      << "as their slots get free";
}

TEST_F(TransmitQueueTest, SdoFramesAreServedInTheOrderTheyCame) {
  push(TransmitClass::sdo, frame(0x67F));
  push(TransmitClass::sdo, frame(0x603));
  push(TransmitClass::sdo, frame(0x601));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x67F})) << "one is in the kernel";
  drain();
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x67F, 0x603, 0x601}));
}

TEST_F(TransmitQueueTest, EqualIdentifiersKeepTheirOrder) {
  see_life();
  for (std::uint8_t i = 0; i < 4; ++i) {
    push(TransmitClass::command, frame(0x205, i));
  }
  drain();
  EXPECT_EQ(link.sent, (std::vector<Frame>{frame(0x205, 0), frame(0x205, 1), frame(0x205, 2), frame(0x205, 3)}));
}

TEST_F(TransmitQueueTest, TheKernelGetsOneOfEachKind) {
  see_life();
  for (std::uint8_t i = 0; i < 2; ++i) {
    push(TransmitClass::sdo, frame(0x601, i));
    push(TransmitClass::repetition, frame(0x205, i));
    push(TransmitClass::command, frame(0x206, i));
    push(TransmitClass::nmt, frame(0x000, i));
    push(TransmitClass::control, frame(0x77F, i));
  }
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x601, 0x205, 0x77F}));
}

TEST_F(TransmitQueueTest, WhatCanMoveAMotorSharesOnePlace) {
  see_life();
  push(TransmitClass::repetition, frame(0x206, 9));
  push(TransmitClass::repetition, frame(0x207, 9));
  push(TransmitClass::command, frame(0x205));
  push(TransmitClass::nmt, frame(0x000));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x206}));
  echo(frame(0x206, 9));
  EXPECT_EQ(sent_ids().back(), 0x000U);
  echo(frame(0x000));
  EXPECT_EQ(sent_ids().back(), 0x205U);
  echo(frame(0x205));
  EXPECT_EQ(sent_ids().back(), 0x207U);
}

TEST_F(TransmitQueueTest, ABusyKernelIsAskedAgainAfterAPauseOrAnEcho) {
  push(TransmitClass::sdo, frame(0x601));
  link.result = SendResult::busy;
  push(TransmitClass::control, frame(0x77F));
  link.result = SendResult::handed_over;
  push(TransmitClass::control, frame(0x080));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x601})) << "asked again at once";
  echo(frame(0x601));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x601, 0x080, 0x77F}));

  link.result = SendResult::busy;
  push(TransmitClass::sdo, frame(0x604));
  link.result = SendResult::handed_over;
  advance(TransmitQueue::kRetry);
  EXPECT_EQ(sent_ids().back(), 0x604U);
}

TEST_F(TransmitQueueTest, AKernelThatStaysBusyIsAskedLessAndLessOften) {
  link.result = SendResult::busy;
  const TimePoint end = now + 1s;
  push(TransmitClass::sdo, frame(0x601));
  int calls = 0;
  for (auto next = queue.next_time(); next && *next < end; next = queue.next_time()) {
    now = *next;
    queue.service(now);
    ++calls;
  }
  EXPECT_LE(calls, 40);
  EXPECT_GE(calls, 25);
  // Once it takes one it is asked soon again.
  link.result = SendResult::handed_over;
  push(TransmitClass::sdo, frame(0x602));
  advance(TransmitQueue::kLongestRetry);
  ASSERT_EQ(sent_ids(), std::vector<std::uint32_t>{0x602});
  link.result = SendResult::busy;
  push(TransmitClass::control, frame(0x77F));
  link.result = SendResult::handed_over;
  advance(TransmitQueue::kRetry);
  EXPECT_EQ(sent_ids().back(), 0x77FU);
}

TEST_F(TransmitQueueTest, AFrameThatCannotLeaveIsDroppedAfterItsTime) {
  link.result = SendResult::busy;
  Sent sent;
  push(sent, TransmitClass::sdo, frame(0x605), 300ms);
  advance(299ms);
  EXPECT_EQ(sent.departure, std::nullopt);
  advance(1ms);
  EXPECT_EQ(sent.departure, Departure::withdrawn);
  link.result = SendResult::handed_over;
  advance(1s);
  EXPECT_TRUE(link.sent.empty());
  EXPECT_EQ(queue.next_time(), std::nullopt);
}

TEST_F(TransmitQueueTest, ALostEchoOfSdoHoldsItsPlaceOnlyForAMoment) {
  Sent lost;
  push(lost, TransmitClass::sdo, frame(0x605, 1));
  push(TransmitClass::sdo, frame(0x605, 2));
  now += 50ms;
  see_life();
  advance(49ms);
  EXPECT_EQ(link.sent.size(), 1U);
  EXPECT_EQ(lost.departure, std::nullopt);
  advance(1ms);
  EXPECT_EQ(lost.departure, Departure::unknown);
  EXPECT_EQ(link.sent.back(), frame(0x605, 2));
}

TEST_F(TransmitQueueTest, OnABusWithoutLifeTheKernelIsNotFilled) {
  see_life();
  advance(5ms);
  push(TransmitClass::sdo, frame(0x605, 1));
  Sent second;
  push(second, TransmitClass::sdo, frame(0x605, 2), 2s);
  advance(999ms);
  EXPECT_EQ(link.sent.size(), 1U) << "nothing was received since";
  advance(1ms);
  EXPECT_EQ(link.sent.size(), 2U) << "others may be silent, and the echo lost";
}

TEST_F(TransmitQueueTest, WhereFramesWereLostTheEchoesMayBeAmongThem) {
  see_life();
  Sent sdo;
  push(sdo, TransmitClass::sdo, frame(0x605, 1));
  Sent repetition;
  push(repetition, TransmitClass::repetition, frame(0x205));
  push(TransmitClass::sdo, frame(0x605, 2));
  now += 5ms;
  EXPECT_FALSE(queue.wants_heartbeat(now));
  queue.on_frames_lost();
  queue.service(now);
  EXPECT_EQ(sdo.departure, Departure::unknown);
  EXPECT_EQ(link.sent.back(), frame(0x605, 2));
  EXPECT_EQ(repetition.departure, std::nullopt) << "what moves a motor is proven to have gone";
  push(TransmitClass::command, frame(0x206));
  EXPECT_EQ(link.sent.back(), frame(0x605, 2));
  echo(frame(0x605, 2));
  EXPECT_EQ(repetition.departure, Departure::unknown);
  EXPECT_EQ(sent_ids().back(), 0x206U);
}

TEST_F(TransmitQueueTest, WhereTheHeartbeatThatWouldTellIsLostTooAnotherIsAskedFor) {
  see_life();
  push(TransmitClass::command, frame(0x205, 1));
  queue.on_frames_lost();
  ASSERT_TRUE(queue.wants_heartbeat(now));
  push(TransmitClass::control, frame(0x77F));
  queue.on_frames_lost();
  advance(99ms);
  see_life();
  EXPECT_FALSE(queue.wants_heartbeat(now));
  advance(2ms);
  ASSERT_TRUE(queue.wants_heartbeat(now));
  push(TransmitClass::control, frame(0x77F));
  echo(frame(0x77F));
  Sent stop;
  push_command(stop, frame(0x205, 0));
  EXPECT_EQ(stop.departure, std::nullopt) << "it is taken";
  EXPECT_EQ(link.sent.back(), frame(0x205, 0));
}

TEST_F(TransmitQueueTest, FourLostEchoesDelayNoCommand) {
  see_life();
  for (std::uint32_t node = 1; node <= 4; ++node) {
    push(TransmitClass::sdo, frame(0x600 + node));
  }
  Sent command;
  push_command(command, frame(0x201));
  EXPECT_EQ(sent_ids().back(), 0x201U);
}

TEST_F(TransmitQueueTest, WithoutEchoOneRepetitionIsInTheKernelAndStaysTheOnlyOne) {
  see_life();
  for (std::uint32_t node = 1; node <= 6; ++node) {
    push(TransmitClass::repetition, frame(0x200 + node));
  }
  Sent again;
  for (int i = 0; i < 50; ++i) {  // Frames of others go on coming.
    advance(100ms);
    see_life();
    again.ticket.reset();
    push(again, TransmitClass::repetition, frame(0x201));
  }
  again.ticket.reset();
  EXPECT_EQ(sent_ids(), std::vector<std::uint32_t>{0x201});
  Sent command;
  push_command(command, frame(0x205));
  EXPECT_EQ(command.departure, std::nullopt) << "it may be a stop, and waits";
  EXPECT_EQ(sent_ids().back(), 0x201U);
  // A heartbeat of ours that comes back proves that it has gone.
  EXPECT_TRUE(queue.wants_heartbeat(now));
  push(TransmitClass::control, frame(0x77F));
  echo(frame(0x77F));
  EXPECT_EQ(sent_ids().back(), 0x205U);
}

TEST_F(TransmitQueueTest, AskedByAHeartbeatAsSoonAsACommandWaitsForAFrameOfOurs) {
  see_life();
  push(TransmitClass::sdo, frame(0x601));  // Its echo is lost.
  advance(25ms);
  EXPECT_FALSE(queue.wants_heartbeat(now)) << "nobody is in a hurry";
  Sent command;
  push_command(command, frame(0x205));
  EXPECT_TRUE(queue.wants_heartbeat(now));
  push(TransmitClass::control, frame(0x77F));
  EXPECT_FALSE(queue.wants_heartbeat(now)) << "once is enough";
  echo(frame(0x77F));
  EXPECT_EQ(sent_ids().back(), 0x205U);
}

TEST_F(TransmitQueueTest, AHeartbeatThatWaitsForTheOneBeforeIsEnough) {
  push(TransmitClass::control, frame(0x77F));
  advance(25ms);
  see_life();
  Sent command;
  push_command(command, frame(0x205));
  push(TransmitClass::control, frame(0x77F));
  EXPECT_EQ(sent_ids(), std::vector<std::uint32_t>{0x77F});
  EXPECT_FALSE(queue.wants_heartbeat(now)) << "each would ask for the next";
}

TEST_F(TransmitQueueTest, SyncAndHeartbeatDoNotHoldEachOtherBack) {
  push(TransmitClass::control, frame(0x080));
  push(TransmitClass::control, frame(0x77F));
  push(TransmitClass::control, frame(0x080));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x080, 0x77F})) << "one of each";
}

TEST_F(TransmitQueueTest, AnEchoThatMayLieInTheSocketIsNotGivenUp) {
  see_life();
  Sent command;
  link.heard = now;
  push_command(command, frame(0x205));
  now += 1s;  // The process stood still.
  queue.service(now);
  EXPECT_EQ(command.departure, std::nullopt);
  echo(frame(0x205));
  EXPECT_EQ(command.departure, Departure::left);
}

TEST_F(TransmitQueueTest, RepetitionsHaveTheirTurnWhateverTheirNode) {
  see_life();
  push(TransmitClass::command, frame(0x300));
  push(TransmitClass::repetition, frame(0x27F));
  push(TransmitClass::repetition, frame(0x201));
  drain();
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x300, 0x27F, 0x201}));
}

TEST_F(TransmitQueueTest, ATicketTellsWhetherItsFrameStillWaits) {
  see_life();
  Sent first;
  Sent second;
  push_command(first, frame(0x205));
  push_command(second, frame(0x206));
  EXPECT_FALSE(first.ticket.waiting());
  EXPECT_TRUE(second.ticket.waiting());
  second.ticket.reset();
  EXPECT_FALSE(second.ticket.waiting());
}

TEST_F(TransmitQueueTest, RepetitionsDoNotGatherWhileTheCableIsOut) {
  see_life();
  Sent repetition;
  Sent heartbeat;
  for (int i = 0; i < 300; ++i) {  // Ten seconds without an echo.
    repetition.ticket.reset();
    push(repetition, TransmitClass::repetition, frame(0x205, 1));
    heartbeat.ticket.reset();
    push(heartbeat, TransmitClass::control, frame(0x77F, 5));
    advance(33ms);
  }
  EXPECT_EQ(std::count(link.sent.begin(), link.sent.end(), frame(0x205, 1)), 1);
  EXPECT_GT(std::count(link.sent.begin(), link.sent.end(), frame(0x77F, 5)), 1) << "our heartbeat goes on trying";
}

TEST_F(TransmitQueueTest, ARepetitionWaitsForASignOfLife) {
  push(TransmitClass::repetition, frame(0x205, 1));
  EXPECT_TRUE(link.sent.empty());
  EXPECT_TRUE(queue.wants_heartbeat(now));
  see_life();
  EXPECT_EQ(link.sent.size(), 1U);
}

TEST_F(TransmitQueueTest, NothingThatWaitedLeavesWhenTheBusReturns) {
  link.result = SendResult::busy;
  Sent command;
  Sent sdo;
  push_command(command, frame(0x205));
  push(sdo, TransmitClass::sdo, frame(0x601));
  queue.on_bus(false);
  EXPECT_EQ(command.departure, Departure::offline);
  EXPECT_EQ(sdo.departure, Departure::offline);
  link.result = SendResult::handed_over;
  queue.on_bus(true);
  see_life();
  advance(10s);
  EXPECT_TRUE(link.sent.empty());
}

TEST_F(TransmitQueueTest, IsBounded) {
  link.result = SendResult::busy;
  for (std::size_t i = 0; i < TransmitQueue::kCapacity; ++i) {
    ASSERT_EQ(push(TransmitClass::sdo, frame(0x605)).departure, std::nullopt);
  }
  Sent command;
  push_command(command, frame(0x205));
  EXPECT_EQ(command.departure, Departure::withdrawn);
  EXPECT_FALSE(command.ticket);
}

TEST_F(TransmitQueueTest, AtLowBitRatesEverythingMayTakeLonger) {
  EXPECT_EQ(TransmitTimes::at(std::nullopt).echo, 100ms);
  EXPECT_EQ(TransmitTimes::at(1'000'000).echo, 100ms);
  EXPECT_EQ(TransmitTimes::at(125'000).behind, 20ms);
  EXPECT_EQ(TransmitTimes::at(10'000).echo, 432ms);
  EXPECT_EQ(TransmitTimes::at(10'000).behind, 81ms);
}

}  // namespace
}  // namespace canopen
