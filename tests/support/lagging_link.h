#pragma once

#include <algorithm>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/post.hpp>
#include <cstddef>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "canopen/bus/link.h"

namespace support {

/// A link that may fall behind, as a socket does whose process is not scheduled: what is received waits with its
/// receive time, and is delivered in batches later. The timers of its owner go on meanwhile, which is worse than a
/// process that stands still.
class LaggingLink final : public canopen::Link, private canopen::LinkEvents {
 public:
  static constexpr std::size_t kBatch = 128;

  LaggingLink(boost::asio::any_io_executor executor, std::unique_ptr<canopen::Link> link)
      : executor_(std::move(executor)), link_(std::move(link)) {}

  /// From now on what is received waits. Of more than `room` frames the newest are lost.
  void stall(std::size_t room = SIZE_MAX) {
    stalled_ = true;
    room_ = room;
    heard_until_ = canopen::Clock::now();
  }
  /// The waiting frames come one batch per turn of the loop, then the number of lost ones.
  void resume() { deliver_later(); }
  [[nodiscard]] std::size_t waiting() const noexcept { return waiting_.size(); }

  void open(canopen::LinkEvents& events) override {
    events_ = &events;
    link_->open(*this);
  }
  void close() override {
    link_->close();
    events_ = nullptr;
  }
  [[nodiscard]] canopen::SendResult send(const canopen::Frame& frame) override { return link_->send(frame); }
  [[nodiscard]] canopen::TimePoint heard_until() override { return stalled_ ? heard_until_ : canopen::Clock::now(); }

 private:
  void on_frames(std::span<const canopen::Received> frames) override {
    if (!stalled_) {
      events_->on_frames(frames);
      return;
    }
    const std::size_t kept = std::min(frames.size(), room_ - std::min(room_, waiting_.size()));
    waiting_.insert(waiting_.end(), frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(kept));
    lost_ += static_cast<std::uint32_t>(frames.size() - kept);
  }
  void on_echo(const canopen::Received& sent) override { events_->on_echo(sent); }
  void on_bus_state(const canopen::BusState& state) override { events_->on_bus_state(state); }
  void on_frames_lost(std::uint32_t count) override { events_->on_frames_lost(count); }

  void deliver_later() {
    boost::asio::post(executor_, [this, alive = std::weak_ptr(alive_)] {
      if (alive.lock() && events_ != nullptr) {
        deliver();
      }
    });
  }
  void deliver() {
    const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(std::min(waiting_.size(), kBatch));
    const std::vector<canopen::Received> batch(waiting_.begin(), end);
    waiting_.erase(waiting_.begin(), end);
    if (!batch.empty()) {
      events_->on_frames(batch);
      heard_until_ = batch.back().at;
    }
    if (!waiting_.empty()) {
      deliver_later();
      return;
    }
    if (lost_ > 0) {
      events_->on_frames_lost(std::exchange(lost_, 0));
    }
    stalled_ = false;
  }

  boost::asio::any_io_executor executor_;
  std::unique_ptr<canopen::Link> link_;
  canopen::LinkEvents* events_ = nullptr;
  bool stalled_ = false;
  std::size_t room_ = 0;
  std::deque<canopen::Received> waiting_;
  std::uint32_t lost_ = 0;
  canopen::TimePoint heard_until_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace support
