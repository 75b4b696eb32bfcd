#include "simulator/error_control.h"

#include <chrono>
#include <utility>

namespace simulator {

ErrorControl::ErrorControl(boost::asio::any_io_executor executor, Actions actions)
    : actions_(std::move(actions)),
      producer_(executor, [this] { actions_.heartbeat(actions_.state()); }),
      life_(executor, [this] { actions_.life_guarding_lost(); }) {}

void ErrorControl::restore_defaults(std::uint16_t heartbeat_ms, std::uint16_t guard_ms, std::uint8_t life_factor) {
  heartbeat_ms_ = heartbeat_ms;
  guard_ms_ = guard_ms;
  life_factor_ = life_factor;
}

void ErrorControl::define(ObjectDictionary& dictionary, bool node_guarding) {
  guarding_ = node_guarding;
  Object heartbeat;
  heartbeat.read = [this] { return heartbeat_ms_; };
  heartbeat.write = [this](std::uint32_t value) {
    set_heartbeat(static_cast<std::uint16_t>(value));
    return Abort::none;
  };
  dictionary.add({0x1017, 0}, std::move(heartbeat));
  if (!guarding_) {
    return;
  }
  Object guard_time;
  guard_time.read = [this] { return guard_ms_; };
  guard_time.write = [this](std::uint32_t value) {
    guard_ms_ = static_cast<std::uint16_t>(value);
    set_life_time();
    return Abort::none;
  };
  dictionary.add({0x100C, 0}, std::move(guard_time));
  Object factor;
  factor.size = 1;
  factor.read = [this] { return life_factor_; };
  factor.write = [this](std::uint32_t value) {
    life_factor_ = static_cast<std::uint8_t>(value);
    set_life_time();
    return Abort::none;
  };
  dictionary.add({0x100D, 0}, std::move(factor));
}

void ErrorControl::start() {
  running_ = true;
  toggle_ = 0;
  life_.stop();
  set_heartbeat(heartbeat_ms_);
}

void ErrorControl::stop() {
  running_ = false;
  producer_.stop();
  life_.stop();
}

void ErrorControl::set_heartbeat(std::uint16_t milliseconds) {
  heartbeat_ms_ = milliseconds;
  producer_.stop();
  if (running_ && heartbeat_ms_ != 0) {
    producer_.repeat(std::chrono::milliseconds(heartbeat_ms_));
    life_.stop();
  }
}

canopen::Duration ErrorControl::life_time() const {
  return std::chrono::milliseconds(guard_ms_) * life_factor_;
}

void ErrorControl::set_life_time() {
  // A running watch takes over the new time; a time of 0 ends it (CiA 301 §7.2.8.2.2.1).
  if (life_time() == canopen::Duration::zero()) {
    life_.stop();
  } else if (life_.running()) {
    life_.start(life_time());
  }
}

void ErrorControl::on_guarding_request() {
  if (!running_ || !guarding_ || heartbeat_ms_ != 0) {
    return;
  }
  actions_.guarding_answer(static_cast<std::uint8_t>(actions_.state() | toggle_));
  toggle_ ^= 0x80U;
  if (life_time() > canopen::Duration::zero()) {
    life_.start(life_time());
  }
}

}  // namespace simulator
