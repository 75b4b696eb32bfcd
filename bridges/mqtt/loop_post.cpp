#include "bridges/mqtt/loop_post.h"

#include <boost/asio/post.hpp>
#include <utility>

namespace mqtt {
namespace {

std::size_t size_of(const Incoming& message) {
  return message.payload.size() + message.topic.size() + message.response_topic.size() +
         (message.correlation ? message.correlation->size() : 0);
}

}  // namespace

void LoopPost::tell_stops_by(IsStop is_stop) {
  const std::lock_guard lock(mutex_);
  is_stop_ = std::move(is_stop);
}

void LoopPost::post(Call call) {
  const std::lock_guard lock(mutex_);
  if (executor_) {
    add(std::move(call));
  }
}

void LoopPost::post_message(Incoming message) {
  const std::lock_guard lock(mutex_);
  if (executor_ && admit(message)) {
    add(std::move(message));
  }
}

void LoopPost::post_watched(Incoming message) {
  const std::lock_guard lock(mutex_);
  if (!executor_) {
    return;
  }
  if (is_stop_ && is_stop_(message)) {  // by the look at all that is kept
    if (admit(message)) {
      add(std::move(message));
    }
    return;
  }
  const std::size_t size = size_of(message);
  const auto known = load_.watched.find(message.topic);
  Incoming* const older = known == load_.watched.end() ? nullptr : std::get_if<Incoming>(&events_[known->second]);
  const std::size_t others = load_.watched_bytes - (older != nullptr ? size_of(*older) : 0);
  if (others + size > kMaxBytes) {
    message = {.topic = std::move(message.topic), .retained = message.retained, .received = message.received};
  }
  if (older == nullptr && (load_.watched.size() >= kMaxTopics || others + size_of(message) > kMaxBytes)) {
    return;  // what was to be put right there is so with the next connection
  }
  load_.watched_bytes = others + size_of(message);
  if (older != nullptr) {
    *older = std::move(message);
    return;
  }
  load_.watched.emplace(message.topic, events_.size());
  add(std::move(message));
}

void LoopPost::add(Event event) {
  events_.push_back(std::move(event));
  if (events_.size() == 1) {
    boost::asio::post(*executor_, [self = shared_from_this()] { self->drain(); });
  }
}

void LoopPost::close() {
  const std::lock_guard lock(mutex_);
  executor_.reset();
  events_.clear();
  is_stop_ = nullptr;
  receiver_ = nullptr;
}

void LoopPost::drain() {
  std::vector<Event> events;
  std::size_t dropped = 0;
  {
    const std::lock_guard lock(mutex_);
    events.swap(events_);
    dropped = std::exchange(load_, {}).dropped;
  }
  const Receiver receiver = receiver_;  // close() may come out of what an event does
  for (Event& event : events) {
    if (!receiver_) {
      return;
    }
    if (auto* message = std::get_if<Incoming>(&event)) {
      receiver(std::move(*message));
    } else {
      std::get<Call>(event)();
    }
  }
  if (dropped > 0 && receiver_) {
    notice_(Level::error, "MQTT: " + std::to_string(dropped) +
                              " commands came faster than they could be taken and were dropped, without an answer");
  }
}

bool LoopPost::admit(const Incoming& message) {
  const std::size_t size = size_of(message);
  if (!load_.full && load_.messages < kMaxMessages && load_.bytes + size <= kMaxBytes) {
    ++load_.messages;
    load_.bytes += size;
    return true;
  }
  load_.full = true;
  if (is_stop_ && is_stop_(message) && admit_stop(message, size)) {
    return true;
  }
  ++load_.dropped;
  return false;
}

bool LoopPost::admit_stop(const Incoming& stop, std::size_t size) {
  const bool fits = load_.stops < kMaxMessages && load_.stop_bytes + size <= kMaxBytes;
  // Nothing but stops comes behind it, so one that is there does all that another would.
  const bool first_on_topic = load_.stops_on.insert(stop.topic).second;
  if (!fits && !first_on_topic) {
    return false;
  }
  ++load_.stops;
  load_.stop_bytes += size;
  return true;
}

}  // namespace mqtt
