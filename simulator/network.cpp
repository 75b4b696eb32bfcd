#include "simulator/network.h"

#include <algorithm>
#include <utility>

namespace simulator {

Network::Network(boost::asio::any_io_executor executor, std::unique_ptr<canopen::Link> link)
    : executor_(std::move(executor)),
      link_(std::move(link)),
      retry_(executor_, [this] { flush(); }),
      tick_(executor_, [this] { tick(); }) {}

Network::~Network() {
  close();
}

void Network::open() {
  if (open_) {
    return;
  }
  open_ = true;
  last_tick_ = canopen::Clock::now();
  tick_.repeat(kTick);
  link_->open(*this);
}

void Network::close() {
  if (!open_) {
    return;
  }
  open_ = false;
  up_ = false;
  link_->close();
  tick_.stop();
  retry_.stop();
  waiting_.clear();
}

bool Network::send(const canopen::Frame& frame) {
  if (!open_ || waiting_.size() >= kCapacity) {
    ++lost_;
    return false;
  }
  if (!waiting_.empty()) {
    waiting_.push_back(frame);
    return true;
  }
  switch (link_->send(frame)) {
    case canopen::SendResult::handed_over:
      return true;
    case canopen::SendResult::busy:
      waiting_.push_back(frame);
      retry_.start(kRetry);
      return true;
    case canopen::SendResult::down:
      break;
  }
  ++lost_;
  return false;
}

void Network::flush() {
  while (!waiting_.empty()) {
    const canopen::SendResult result = link_->send(waiting_.front());
    if (result == canopen::SendResult::busy) {
      retry_.start(kRetry);
      return;
    }
    if (result == canopen::SendResult::down) {
      lost_ += waiting_.size();
      waiting_.clear();
      return;
    }
    waiting_.pop_front();
  }
}

void Network::attach(Station& station) {
  stations_.push_back(&station);
}

void Network::detach(Station& station) {
  std::erase(stations_, &station);
}

void Network::hand_out(const canopen::Frame& frame) {
  // By position: a station may come or go while another handles the frame.
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    stations_[i]->on_frame(frame);
  }
}

void Network::tick() {
  const canopen::TimePoint now = canopen::Clock::now();
  const canopen::Duration passed = now - last_tick_;
  last_tick_ = now;
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    stations_[i]->on_tick(passed);
  }
}

void Network::on_frames(std::span<const canopen::Received> frames) {
  for (const canopen::Received& received : frames) {
    hand_out(received.frame);
  }
}

void Network::on_echo(const canopen::Received& sent) {
  // Drives on one link hear one another, as on a cable.
  hand_out(sent.frame);
  flush();
}

void Network::on_bus_state(const canopen::BusState& state) {
  const bool was_up = std::exchange(up_, state.up());
  if (!up_) {
    lost_ += waiting_.size();
    waiting_.clear();
    return;
  }
  if (!was_up) {
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      stations_[i]->on_bus_up();
    }
  }
}

void Network::on_frames_lost(std::uint32_t count) {
  lost_ += count;
}

}  // namespace simulator
