#include "simulator/heartbeat_consumer.h"

#include <chrono>
#include <utility>

namespace simulator {
namespace {

std::uint8_t node_of(std::uint32_t value) noexcept {
  return static_cast<std::uint8_t>(value >> 16U);
}

std::uint16_t milliseconds_of(std::uint32_t value) noexcept {
  return static_cast<std::uint16_t>(value);
}

std::uint8_t sub_of(std::size_t position) noexcept {
  return static_cast<std::uint8_t>(position + 1);
}

}  // namespace

HeartbeatConsumer::HeartbeatConsumer(boost::asio::any_io_executor executor, Action lost, Action cleared)
    : executor_(std::move(executor)), lost_(std::move(lost)), cleared_(std::move(cleared)) {}

void HeartbeatConsumer::restore_defaults(std::uint8_t entries) {
  entries_.clear();
  for (std::size_t i = 0; i < entries; ++i) {
    entries_.push_back({0, false, std::make_unique<Alarm>(executor_, [this, i] { expire(i); })});
  }
}

void HeartbeatConsumer::define(ObjectDictionary& dictionary) {
  if (entries_.empty()) {
    return;
  }
  dictionary.add_constant({0x1016, 0}, 1, static_cast<std::uint32_t>(entries_.size()));
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Object entry;
    entry.size = 4;
    entry.read = [this, i] { return entries_[i].value; };
    entry.write = [this, i](std::uint32_t value) { return set(i, value); };
    dictionary.add({0x1016, sub_of(i)}, std::move(entry));
  }
}

void HeartbeatConsumer::restart() {
  for (Entry& entry : entries_) {
    entry.alarm->stop();
    entry.lost = false;
  }
}

Abort HeartbeatConsumer::set(std::size_t position, std::uint32_t value) {
  Entry& entry = entries_[position];
  const std::uint8_t old_node = node_of(entry.value);
  entry.value = value;
  entry.alarm->stop();
  if (std::exchange(entry.lost, false)) {
    cleared_(sub_of(position), old_node);
  }
  return Abort::none;
}

void HeartbeatConsumer::on_heartbeat(std::uint8_t node) {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Entry& entry = entries_[i];
    if (node == 0 || node_of(entry.value) != node || milliseconds_of(entry.value) == 0) {
      continue;
    }
    entry.alarm->start(std::chrono::milliseconds(milliseconds_of(entry.value)));
    if (std::exchange(entry.lost, false)) {
      cleared_(sub_of(i), node);
    }
  }
}

void HeartbeatConsumer::expire(std::size_t position) {
  entries_[position].lost = true;
  lost_(sub_of(position), node_of(entries_[position].value));
}

}  // namespace simulator
