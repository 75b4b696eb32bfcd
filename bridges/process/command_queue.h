#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <deque>

#include "canopen/clock.h"
#include "canopen/event.h"

namespace process {

/// Commands of one drive in order of arrival, one at a time. Outlives its tickets.
class CommandQueue {
 public:
  explicit CommandQueue(boost::asio::any_io_executor executor);

  /// A command's place in the queue, from its arrival to its answer.
  class Ticket {
   public:
    explicit Ticket(CommandQueue& queue);
    ~Ticket();
    Ticket(const Ticket&) = delete;
    Ticket& operator=(const Ticket&) = delete;

   private:
    CommandQueue& queue_;
  };

  /// Somebody who does not queue, but must have left before the owner goes.
  class Visit {
   public:
    explicit Visit(CommandQueue& queue) : queue_(queue) { ++queue_.visits_; }
    ~Visit() {
      --queue_.visits_;
      queue_.changed_.notify();
    }
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

   private:
    CommandQueue& queue_;
  };

  /// Waits for its turn: false where `deadline` passed or the queue closed before.
  boost::asio::awaitable<bool> turn(const Ticket& ticket, canopen::TimePoint deadline);

  /// Gives nobody a turn any more.
  void close();
  [[nodiscard]] bool closed() const noexcept { return closed_; }
  /// Returns once the last ticket and visit are gone.
  boost::asio::awaitable<void> until_empty();

 private:
  canopen::Event changed_;
  std::deque<const Ticket*> tickets_;
  std::size_t visits_ = 0;
  bool closed_ = false;
};

}  // namespace process
