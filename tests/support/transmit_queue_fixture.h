#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <vector>

#include "canopen/bus/transmit_queue.h"
#include "tests/support/frame.h"

namespace support {

/// A kernel that takes what it is told to take.
class FakeLink final : public canopen::Link {
 public:
  void open(canopen::LinkEvents&) override {}
  void close() override {}
  canopen::SendResult send(const canopen::Frame& frame) override {
    if (result == canopen::SendResult::handed_over) {
      sent.push_back(frame);
    }
    return result;
  }
  canopen::TimePoint heard_until() override { return heard; }

  canopen::TimePoint heard = canopen::kNever;  ///< All that was received before has been read.
  canopen::SendResult result = canopen::SendResult::handed_over;
  std::vector<canopen::Frame> sent;
};

class TransmitQueueFixture : public ::testing::Test {
 protected:
  TransmitQueueFixture() { queue.on_bus(true); }

  /// A frame and what became of it. Not to be moved while it is on its way.
  struct Sent {
    std::optional<canopen::Departure> departure;
    canopen::Ticket ticket;
  };
  void push(Sent& sent, canopen::TransmitClass transmit_class, const canopen::Frame& content,
            canopen::Duration deadline = canopen::TransmitQueue::kLifeTime) {
    sent.departure.reset();
    sent.ticket = queue.push(
        transmit_class, content, now + deadline,
        [&sent](canopen::Departure departure) {
          EXPECT_FALSE(sent.departure) << "told twice";
          sent.departure = departure;
        },
        now);
    queue.service(now);
  }
  void push_command(Sent& sent, const canopen::Frame& content,
                    canopen::Duration deadline = std::chrono::milliseconds(800)) {
    push(sent, canopen::TransmitClass::command, content, deadline);
  }
  /// One that nobody asks for again.
  Sent& push(canopen::TransmitClass transmit_class, const canopen::Frame& content) {
    Sent& sent = *kept_.emplace_back(std::make_unique<Sent>());
    push(sent, transmit_class, content);
    return sent;
  }
  void echo(const canopen::Frame& content) {
    queue.on_echo(content, now);
    queue.service(now);
  }
  /// Echoes what the kernel has, oldest first, until nothing is left.
  void drain() {
    for (std::size_t i = 0; i < link.sent.size(); ++i) {
      echo(link.sent[i]);
    }
  }
  void see_life() {
    queue.on_received(now);
    queue.service(now);
  }
  /// Moves time on, and calls the queue whenever it wanted to be called.
  void advance(canopen::Duration by) {
    const canopen::TimePoint end = now + by;
    while (const auto next = queue.next_time()) {
      if (*next > end) {
        break;
      }
      ASSERT_GE(*next, now) << "the queue asks for a moment in the past";
      now = *next;
      queue.service(now);
    }
    now = end;
    queue.service(now);
  }
  [[nodiscard]] std::vector<std::uint32_t> sent_ids() const {
    std::vector<std::uint32_t> ids;
    for (const canopen::Frame& sent : link.sent) {
      ids.push_back(sent.id);
    }
    return ids;
  }

  FakeLink link;
  canopen::TransmitQueue queue{link};
  canopen::TimePoint now{std::chrono::hours(1)};

 private:
  std::vector<std::unique_ptr<Sent>> kept_;
};

}  // namespace support
