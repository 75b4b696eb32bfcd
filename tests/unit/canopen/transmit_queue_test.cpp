#include "canopen/transmit_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/transmit_queue_fixture.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;

class TransmitQueueTest : public support::TransmitQueueFixture {};

TEST_F(TransmitQueueTest, TheKernelGetsAHandfulAndTheRestByPriority) {
  for (const std::uint32_t id : {0x605U, 0x601U, 0x77FU, 0x602U}) {
    push(frame(id));
  }
  push(frame(0x603));
  push(frame(0x080));
  push(frame(0x601, 1));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x605, 0x601, 0x77F, 0x602}));
  echo(frame(0x605));
  EXPECT_EQ(sent_ids().back(), 0x080U);
  echo(frame(0x601));
  EXPECT_EQ(link.sent.back(), frame(0x601, 1));
  echo(frame(0x77F));
  EXPECT_EQ(sent_ids().back(), 0x603U);
  EXPECT_TRUE(queue.idle());
}

TEST_F(TransmitQueueTest, EqualIdentifiersKeepTheirOrder) {
  link.result = SendResult::busy;
  for (std::uint8_t i = 0; i < 4; ++i) {
    push(frame(0x605, i));
  }
  link.result = SendResult::handed_over;
  advance(2ms);
  EXPECT_EQ(link.sent, (std::vector<Frame>{frame(0x605, 0), frame(0x605, 1), frame(0x605, 2), frame(0x605, 3)}));
}

TEST_F(TransmitQueueTest, ABusyKernelIsAskedAgainAfterAPauseOrAnEcho) {
  push(frame(0x601));
  link.result = SendResult::busy;
  push(frame(0x602));
  link.result = SendResult::handed_over;
  push(frame(0x603));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x601})) << "asked again at once";
  echo(frame(0x601));
  EXPECT_EQ(sent_ids(), (std::vector<std::uint32_t>{0x601, 0x602, 0x603}));

  link.result = SendResult::busy;
  push(frame(0x604));
  link.result = SendResult::handed_over;
  advance(TransmitQueue::kRetry);
  EXPECT_EQ(sent_ids().back(), 0x604U);
}

TEST_F(TransmitQueueTest, LostEchoesDoNotCloseTheWindowForEver) {
  for (std::uint8_t i = 0; i < 10; ++i) {
    push(frame(0x605, i));
  }
  EXPECT_EQ(link.sent.size(), TransmitQueue::kMaxInKernel);
  advance(1s);
  // What waited for a second is dropped; what the kernel had is no longer counted.
  EXPECT_TRUE(queue.idle());
  push(frame(0x601));
  EXPECT_EQ(sent_ids().back(), 0x601U);
}

TEST_F(TransmitQueueTest, AFrameThatCannotLeaveIsDroppedAfterASecond) {
  link.result = SendResult::busy;
  push(frame(0x605));
  advance(1s);
  link.result = SendResult::handed_over;
  advance(1s);
  EXPECT_TRUE(link.sent.empty());
  EXPECT_EQ(queue.next_time(), std::nullopt);
}

TEST_F(TransmitQueueTest, OnlyTheNewestOfARepeatedFrameWaits) {
  link.result = SendResult::busy;
  EXPECT_TRUE(queue.push_latest(frame(0x205, 1), now));
  EXPECT_TRUE(queue.push_latest(frame(0x206, 9), now));
  EXPECT_TRUE(queue.push_latest(frame(0x205, 2), now));
  EXPECT_TRUE(queue.push(frame(0x205, 3), now)) << "an ordinary frame is never replaced";
  link.result = SendResult::handed_over;
  queue.service(now);
  EXPECT_EQ(link.sent, (std::vector<Frame>{frame(0x205, 2), frame(0x205, 3), frame(0x206, 9)}));
}

TEST_F(TransmitQueueTest, ARepeatedFrameWaitsForItsPredecessor) {
  EXPECT_TRUE(queue.push_latest(frame(0x205, 1), now));
  queue.service(now);
  EXPECT_TRUE(queue.push_latest(frame(0x205, 2), now));
  EXPECT_TRUE(queue.push_latest(frame(0x205, 3), now));
  queue.service(now);
  EXPECT_EQ(link.sent.size(), 1U);
  echo(frame(0x205, 1));
  EXPECT_EQ(link.sent.back(), frame(0x205, 3));
}

TEST_F(TransmitQueueTest, ACommandIsNeverFollowedByAnOlderRepetition) {
  link.result = SendResult::busy;
  EXPECT_TRUE(queue.push_repetition(frame(0x205, 1), now));
  Command command;
  push_command(command, frame(0x205, 2));
  EXPECT_FALSE(queue.push_repetition(frame(0x205, 1), now)) << "a command of its COB-ID waits";
  link.result = SendResult::handed_over;
  see_life();
  advance(2ms);
  EXPECT_EQ(link.sent, (std::vector<Frame>{frame(0x205, 2)}));
  EXPECT_FALSE(queue.push_repetition(frame(0x205, 1), now)) << "a command of its COB-ID is leaving";
  echo(frame(0x205, 2));
  EXPECT_TRUE(queue.push_repetition(frame(0x205, 2), now));
}

TEST_F(TransmitQueueTest, RepetitionsDoNotGatherWhileTheCableIsOut) {
  see_life();
  for (int i = 0; i < 300; ++i) {  // Ten seconds without an echo.
    EXPECT_TRUE(queue.push_repetition(frame(0x205, 1), now));
    EXPECT_TRUE(queue.push_latest(frame(0x77F, 5), now));
    advance(33ms);
  }
  EXPECT_EQ(std::count(link.sent.begin(), link.sent.end(), frame(0x205, 1)), 1);
  EXPECT_GT(std::count(link.sent.begin(), link.sent.end(), frame(0x77F, 5)), 1) << "our heartbeat goes on trying";
}

TEST_F(TransmitQueueTest, ARepetitionWaitsForASignOfLife) {
  EXPECT_TRUE(queue.push_repetition(frame(0x205, 1), now));
  queue.service(now);
  EXPECT_TRUE(link.sent.empty());
  EXPECT_TRUE(queue.wants_sign_of_life(now));
  see_life();
  queue.service(now);
  EXPECT_EQ(link.sent.size(), 1U);
}

TEST_F(TransmitQueueTest, NothingThatWaitedLeavesWhenTheBusReturns) {
  link.result = SendResult::busy;
  Command command;
  push_command(command, frame(0x205));
  push(frame(0x601));
  queue.on_bus(false);
  link.result = SendResult::handed_over;
  queue.on_bus(true);
  see_life();
  advance(10s);
  EXPECT_TRUE(link.sent.empty());
}

TEST_F(TransmitQueueTest, IsBounded) {
  link.result = SendResult::busy;
  std::size_t taken = 0;
  while (queue.push(frame(0x605), now) && taken < 2 * TransmitQueue::kCapacity) {
    ++taken;
  }
  EXPECT_EQ(taken, TransmitQueue::kCapacity);
  Command command;
  push_command(command, frame(0x205));
  EXPECT_EQ(command.departure, Departure::withdrawn);
}

}  // namespace
}  // namespace canopen
