#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <functional>

#include "canopen/frame.h"
#include "simulator/alarm.h"
#include "simulator/object_dictionary.h"

namespace simulator {

/// Heartbeat producer (0x1017) and node guarding (0x100C, 0x100D). Never both: guarding is answered only while the
/// heartbeat time is 0.
class ErrorControl {
 public:
  struct Actions {
    std::function<std::uint8_t()> state;                 ///< NMT state as heartbeats carry it
    std::function<void(std::uint8_t status)> heartbeat;  ///< sends one
    std::function<void(std::uint8_t status)> guarding_answer;
    std::function<void()> life_guarding_lost;
  };

  ErrorControl(boost::asio::any_io_executor executor, Actions actions);

  void restore_defaults(std::uint16_t heartbeat_ms, std::uint16_t guard_ms, std::uint8_t life_factor);
  void define(ObjectDictionary& dictionary, bool node_guarding);
  /// From the boot-up on; the toggle bit starts at 0.
  void start();
  void stop();
  /// A remote request for 0x700 + node arrived.
  void on_guarding_request();

 private:
  void set_heartbeat(std::uint16_t milliseconds);
  void set_life_time();
  [[nodiscard]] canopen::Duration life_time() const;

  Actions actions_;
  Alarm producer_;
  Alarm life_;
  std::uint16_t heartbeat_ms_ = 0;
  std::uint16_t guard_ms_ = 0;
  std::uint8_t life_factor_ = 0;
  bool guarding_ = false;
  bool running_ = false;
  std::uint8_t toggle_ = 0;
};

}  // namespace simulator
