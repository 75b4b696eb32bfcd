// Stops in the transmit queue: before everything else, and held back by nothing that moves no motor.

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "canopen/bus/transmit_queue.h"
#include "tests/support/transmit_queue_fixture.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;

class TransmitQueueStopTest : public support::TransmitQueueFixture {};

TEST_F(TransmitQueueStopTest, AStopGoesBeforeEverythingElse) {
  link.result = SendResult::busy;
  push(TransmitClass::command, frame(0x205));
  push(TransmitClass::nmt, frame(0x000));
  push(TransmitClass::stop, frame(0x605));
  push(TransmitClass::stop, frame(0x204));
  link.result = SendResult::handed_over;
  see_life();
  advance(2ms);
  drain();
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x605, 0x204, 0x000, 0x205})) << "of stops the older first";
}

TEST_F(TransmitQueueStopTest, AStopWaitsForTheEchoOfTheCommandBeforeIt) {
  see_life();
  push(TransmitClass::command, frame(0x205, 1));
  push(TransmitClass::stop, frame(0x205, 0));
  EXPECT_EQ(link.sent, std::vector<Frame>{frame(0x205, 1)}) << "they leave in their order";
  echo(frame(0x205, 1));
  EXPECT_EQ(link.sent.back(), frame(0x205, 0));
  push(TransmitClass::command, frame(0x206));
  EXPECT_EQ(link.sent.size(), 2U) << "nor does a command go beside a stop";
  echo(frame(0x205, 0));
  EXPECT_EQ(sent_ids().back(), 0x206U);
}

TEST_F(TransmitQueueStopTest, AStopWaitsForNoStuckFrameThatMovesNoMotor) {
  push(TransmitClass::sdo, frame(0x601));
  push(TransmitClass::control, frame(0x77F));
  advance(25ms);
  see_life();
  Sent command;
  push_command(command, frame(0x206));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x601, 0x77F}));
  push(TransmitClass::stop, frame(0x205));
  EXPECT_EQ(sent_ids().back(), 0x205U);
  echo(frame(0x205));
  EXPECT_EQ(sent_ids().back(), 0x205U) << "the command still waits for the proof";
}

TEST_F(TransmitQueueStopTest, AStopDoesNotWaitForWhatWasGivenUpWithoutProof) {
  see_life();
  push(TransmitClass::sdo, frame(0x601));
  queue.on_frames_lost();
  push(TransmitClass::command, frame(0x206));
  ASSERT_EQ(sent_ids(), std::vector<std::uint32_t>{0x601});
  push(TransmitClass::stop, frame(0x205));
  EXPECT_EQ(sent_ids().back(), 0x205U);
}

TEST_F(TransmitQueueStopTest, BehindAnOverdueCommandAStopWaitsForTheProofOrItsDeadline) {
  see_life();
  Sent run;
  push_command(run, frame(0x205, 1), 50ms);
  advance(101ms);
  see_life();
  ASSERT_EQ(run.departure, Departure::unknown);
  Sent refused;
  push_command(refused, frame(0x206));
  ASSERT_EQ(refused.departure, Departure::offline);
  Sent early;
  Sent stop;
  push(early, TransmitClass::stop, frame(0x205, 2), 300ms);
  push(stop, TransmitClass::stop, frame(0x205, 0), 800ms);
  EXPECT_TRUE(queue.wants_heartbeat(now));
  advance(300ms);
  EXPECT_EQ(early.departure, Departure::withdrawn);
  EXPECT_EQ(stop.departure, std::nullopt);
  EXPECT_EQ(link.sent.size(), 1U);
  push(TransmitClass::control, frame(0x77F));
  echo(frame(0x205, 1));
  EXPECT_EQ(link.sent.back(), frame(0x205, 0));
}

TEST_F(TransmitQueueStopTest, AStopOnASilentBusWaitsForNoSignOfLife) {
  push(TransmitClass::command, frame(0x206));
  push(TransmitClass::stop, frame(0x205));
  EXPECT_EQ(sent_ids(), std::vector<std::uint32_t>{0x205}) << "a stop that leaves late moves nothing";
}

TEST_F(TransmitQueueStopTest, AFullQueueMakesRoomForAStop) {
  link.result = SendResult::busy;
  push(TransmitClass::command, frame(0x206));
  const Sent* last = nullptr;
  for (std::size_t i = 1; i < TransmitQueue::kCapacity; ++i) {
    last = &push(TransmitClass::sdo, frame(0x605));
  }
  Sent stop;
  push(stop, TransmitClass::stop, frame(0x205));
  EXPECT_EQ(stop.departure, std::nullopt);
  EXPECT_EQ(last->departure, Departure::withdrawn) << "the newest of the lowest class";
  EXPECT_FALSE(last->ticket.waiting());
  see_life();
  link.result = SendResult::handed_over;
  advance(TransmitQueue::kLongestRetry);
  EXPECT_EQ(sent_ids().front(), 0x205U);
}

// The echo of a command was lost, and our heartbeat proves that it has gone.
TEST_F(TransmitQueueStopTest, AStopGoesOnceTheCommandBeforeItIsProvenGone) {
  see_life();
  push(TransmitClass::command, frame(0x205, 1));
  advance(21ms);
  push(TransmitClass::stop, frame(0x205, 0));
  push(TransmitClass::control, frame(0x77F));
  echo(frame(0x77F));
  EXPECT_EQ(link.sent.back(), frame(0x205, 0));
  advance(78ms);
  EXPECT_EQ(link.sent.back(), frame(0x205, 0)) << "99 ms later";
}

}  // namespace
}  // namespace canopen
