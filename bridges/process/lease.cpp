#include "bridges/process/lease.h"

#include <algorithm>
#include <chrono>

namespace process {
namespace {

// More writers than a plant has; so that changing addresses do not fill the memory.
constexpr std::size_t kMostBlocked = 64;

// `4.2 s`, rounded up: never 0.0.
std::string time_left_text(canopen::Duration left) {
  const auto tenths = std::chrono::ceil<std::chrono::duration<std::int64_t, std::deci>>(left).count();
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " s";
}

}  // namespace

bool Lease::is_held_by_another(const Writer& writer, canopen::TimePoint now) const {
  return holder_ && now < until_ && *holder_ != writer;
}

std::optional<std::string> Lease::refuse(const Writer& writer, ControlUse use, canopen::TimePoint now) const {
  if (use == ControlUse::stop) {
    return std::nullopt;
  }
  if (is_held_by_another(writer, now)) {
    return to_string(*holder_) + " holds the lease, for another " + time_left_text(until_ - now) + " unless renewed";
  }
  const auto blocked = std::ranges::find(blocked_, writer, &Blocked::writer);
  if (use == ControlUse::none || blocked == blocked_.end()) {
    return std::nullopt;
  }
  return "stopped by " + to_string(blocked->by) + ": " + to_string(writer) + " has to write a stop value first";
}

void Lease::on_accepted(const Writer& writer, ControlUse use, canopen::TimePoint now) {
  if (length_ == canopen::Duration::zero()) {
    return;
  }
  expire(now);
  if (use == ControlUse::stop) {
    std::erase_if(blocked_, [&](const Blocked& blocked) { return blocked.writer == writer; });
  }
  if (is_held_by_another(writer, now)) {
    if (use == ControlUse::stop) {
      block_holder(writer);
    }
    return;
  }
  if (!holder_) {
    holder_ = writer;
    since_ = canopen::wall_now();
  }
  until_ = now + length_;
}

void Lease::block_holder(const Writer& by) {
  std::erase_if(blocked_, [&](const Blocked& blocked) { return blocked.writer == *holder_; });
  if (blocked_.size() == kMostBlocked) {
    blocked_.erase(blocked_.begin());
  }
  blocked_.push_back({.writer = *holder_, .by = by});
}

void Lease::expire(canopen::TimePoint now) {
  if (holder_ && now >= until_) {
    holder_.reset();
    since_ = {};
    until_ = canopen::kNever;
  }
}

}  // namespace process
