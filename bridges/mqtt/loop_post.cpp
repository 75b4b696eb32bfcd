#include "bridges/mqtt/loop_post.h"

#include <boost/asio/post.hpp>
#include <utility>

namespace mqtt {

void LoopPost::post(LoopEvent event) {
  const std::lock_guard lock(mutex_);
  if (!executor_ || !admit(event)) {
    return;
  }
  events_.push_back(std::move(event));
  if (events_.size() == 1) {
    boost::asio::post(*executor_, [self = shared_from_this()] { self->drain(); });
  }
}

void LoopPost::close() {
  const std::lock_guard lock(mutex_);
  executor_.reset();
  events_.clear();
  receiver_ = nullptr;
}

void LoopPost::drain() {
  std::vector<LoopEvent> events;
  std::size_t dropped = 0;
  {
    const std::lock_guard lock(mutex_);
    events.swap(events_);
    messages_ = 0;
    bytes_ = 0;
    dropped = std::exchange(dropped_, 0);
  }
  if (dropped > 0) {
    events.emplace_back(Said{Level::error, "MQTT: " + std::to_string(dropped) +
                                               " commands came faster than they could be taken and were dropped"});
  }
  const Receiver receiver = receiver_;  // close() may come out of what an event does
  for (LoopEvent& event : events) {
    if (!receiver_) {
      return;
    }
    receiver(event);
  }
}

bool LoopPost::admit(const LoopEvent& event) {
  const auto* message = std::get_if<Incoming>(&event);
  if (message == nullptr) {
    return true;
  }
  const std::size_t size = message->payload.size() + message->topic.size();
  if (messages_ >= kMaxMessages || bytes_ + size > kMaxBytes) {
    ++dropped_;
    return false;
  }
  ++messages_;
  bytes_ += size;
  return true;
}

}  // namespace mqtt
