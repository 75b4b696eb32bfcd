#pragma once

#include <cstdint>
#include <optional>

#include "canopen/frame.h"
#include "simulator/alarm.h"
#include "simulator/pdo_settings.h"

namespace simulator {

/// One RPDO: takes frames in the operational state and writes the mapped objects.
class ReceivePdo {
 public:
  /// `number` from 1. The context outlives it.
  ReceivePdo(std::uint8_t number, PdoContext& context);

  [[nodiscard]] PdoSettings& settings() noexcept { return settings_; }
  [[nodiscard]] std::uint8_t number() const noexcept { return number_; }
  void stop();
  void apply_settings();

  /// True when it took the frame's objects over at once.
  bool on_frame(const canopen::Frame& frame);
  /// True when it took a waiting frame over.
  bool on_sync();

 private:
  [[nodiscard]] bool length_is_right(const canopen::Frame& frame);
  void take(const canopen::Frame& frame);

  std::uint8_t number_;
  PdoContext& context_;
  PdoSettings settings_;
  std::optional<canopen::Frame> held_;  ///< Waits for the SYNC.
  Alarm deadline_;
};

}  // namespace simulator
