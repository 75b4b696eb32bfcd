#include "bridges/process/command_queue.h"

#include <utility>

namespace process {

CommandQueue::CommandQueue(boost::asio::any_io_executor executor) : changed_(std::move(executor)) {}

CommandQueue::Ticket::Ticket(CommandQueue& queue) : queue_(queue) {
  queue_.tickets_.push_back(this);
}

CommandQueue::Ticket::~Ticket() {
  std::erase(queue_.tickets_, this);
  queue_.changed_.notify();
}

boost::asio::awaitable<bool> CommandQueue::turn(const Ticket& ticket, canopen::TimePoint deadline) {
  while (!closed_ && canopen::Clock::now() < deadline) {
    if (tickets_.front() == &ticket) {
      co_return true;
    }
    co_await changed_.wait_until(deadline);
  }
  co_return false;
}

void CommandQueue::close() {
  closed_ = true;
  changed_.notify();
}

boost::asio::awaitable<void> CommandQueue::until_empty() {
  while (!tickets_.empty() || visits_ > 0) {
    co_await changed_.wait_until(canopen::TimePoint::max());
  }
}

}  // namespace process
