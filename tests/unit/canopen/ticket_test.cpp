// A frame belongs to its ticket: it is withdrawn with it, unless the kernel has it.

#include "canopen/bus/ticket.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/support/transmit_queue_fixture.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;

class TicketTest : public support::TransmitQueueFixture {};

TEST_F(TicketTest, ATicketThatGoesWithdrawsItsFrameSilently) {
  Sent command;
  push_command(command, frame(0x205));
  command.ticket.reset();
  see_life();
  EXPECT_TRUE(link.sent.empty());

  for (const TransmitClass transmit_class : {TransmitClass::nmt, TransmitClass::control, TransmitClass::command,
                                             TransmitClass::repetition, TransmitClass::sdo}) {
    link.result = SendResult::busy;
    Sent sent;
    push(sent, transmit_class, frame(0x206));
    {
      const Ticket owner = std::move(sent.ticket);
    }
    link.result = SendResult::handed_over;
    advance(1s);
    EXPECT_TRUE(link.sent.empty());
    EXPECT_EQ(sent.departure, std::nullopt);
    see_life();
  }
}

TEST_F(TicketTest, ATicketThatGoesWhileTheKernelHasItsFrameTellsNothing) {
  see_life();
  Sent command;
  push_command(command, frame(0x205));
  command.ticket.reset();
  echo(frame(0x205));
  EXPECT_EQ(command.departure, std::nullopt);
  push_command(command, frame(0x206));
  EXPECT_EQ(sent_ids().back(), 0x206U);
}

TEST_F(TicketTest, ANewTicketTakesThePlaceOfTheOneBefore) {
  link.result = SendResult::busy;
  Ticket heartbeat = queue.push(TransmitClass::control, frame(0x77F, 1), now + 1s, {}, now);
  heartbeat = queue.push(TransmitClass::control, frame(0x77F, 2), now + 1s, {}, now);
  link.result = SendResult::handed_over;
  queue.service(now);
  advance(1s);
  EXPECT_EQ(link.sent, std::vector<Frame>{frame(0x77F, 2)});
}

TEST_F(TicketTest, WithdrawingTellsSo) {
  link.result = SendResult::busy;
  see_life();
  Sent command;
  Sent other;
  push_command(command, frame(0x205, 1));
  push_command(other, frame(0x205, 2));
  command.ticket.withdraw();
  EXPECT_EQ(command.departure, Departure::withdrawn);
  EXPECT_EQ(other.departure, std::nullopt);
  link.result = SendResult::handed_over;
  advance(4ms);
  EXPECT_EQ(link.sent, std::vector<Frame>{frame(0x205, 2)});
}

TEST_F(TicketTest, WhatTheKernelHasCannotBeWithdrawn) {
  see_life();
  Sent command;
  push_command(command, frame(0x205));
  command.ticket.withdraw();
  EXPECT_EQ(command.departure, std::nullopt);
  echo(frame(0x205));
  EXPECT_EQ(command.departure, Departure::left);
}

}  // namespace
}  // namespace canopen
