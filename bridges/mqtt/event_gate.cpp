#include "bridges/mqtt/event_gate.h"

#include <system_error>
#include <thread>
#include <utility>

namespace mqtt {

void EventGate::close() {
  const std::lock_guard<std::mutex> lock(mutex_);
  events_ = nullptr;
}

void EventGate::on_up(BrokerLimits limits) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (events_ != nullptr) {
    events_->on_up(limits);
  }
}

void EventGate::on_refused(Refusal refusal) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (events_ != nullptr) {
    events_->on_refused(std::move(refusal));
  }
}

void EventGate::on_down(int code) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (events_ != nullptr) {
    events_->on_down(code);
  }
}

void EventGate::on_incoming(Incoming&& message) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (events_ != nullptr) {
    events_->on_incoming(std::move(message));
  }
}

void EventGate::on_sent(const Message* message, Delivery delivery, int code) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (events_ != nullptr) {
    events_->on_sent(message, delivery, code);
  }
}

void EventGate::on_subscribed(Subscribed&& subscribed) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (events_ != nullptr) {
    events_->on_subscribed(std::move(subscribed));
  }
}

void EventGate::on_unsubscribed(const std::string& filter) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (events_ != nullptr) {
    events_->on_unsubscribed(filter);
  }
}

std::future<void> let_go(std::unique_ptr<Client> client, std::unique_ptr<EventGate> gate) {
  gate->close();
  std::packaged_task<void()> task([left = std::move(client), closed = std::move(gate)]() mutable {
    left.reset();  // before its gate
    closed.reset();
  });
  std::future<void> gone = task.get_future();
  try {
    std::thread(std::move(task)).detach();
  } catch (const std::system_error&) {  // NOLINT(bugprone-empty-catch)
    // No thread is to be had: `task` went with the client in it, here.
  }
  return gone;
}

}  // namespace mqtt
