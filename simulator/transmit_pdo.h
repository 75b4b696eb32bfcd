#pragma once

#include <cstdint>
#include <optional>

#include "canopen/frame.h"
#include "simulator/alarm.h"
#include "simulator/pdo_settings.h"

namespace simulator {

/// One TPDO in the operational state: decides when to send.
class TransmitPdo {
 public:
  /// `number` from 1. The context outlives it.
  TransmitPdo(std::uint8_t number, PdoContext& context);

  [[nodiscard]] PdoSettings& settings() noexcept { return settings_; }
  void start();  ///< Operational from now on.
  void stop();
  void apply_settings();  ///< They have changed; running timers follow.

  void on_sync(std::optional<std::uint8_t> counter);
  void on_remote_request();
  void on_rpdo();  ///< The RPDO of the same number was received.
  void look_for_change();

 private:
  [[nodiscard]] bool changed(const canopen::Frame& frame) const;
  [[nodiscard]] bool sync_started(std::optional<std::uint8_t> counter);
  [[nodiscard]] canopen::Duration inhibit_time() const;
  void request();
  void end_inhibit();
  void send(const canopen::Frame& frame);

  std::uint8_t number_;
  PdoContext& context_;
  PdoSettings settings_;
  Triggers triggers_;
  bool running_ = false;
  bool waiting_ = false;       ///< Wanted to leave during the inhibit time.
  bool sync_started_ = false;  ///< The SYNC counter has reached the start value.
  std::uint8_t syncs_ = 0;     ///< since the last one sent on SYNC
  std::optional<canopen::Frame> last_;
  std::optional<canopen::Frame> sample_;  ///< Type 252: taken at the SYNC, sent on request.
  Alarm event_;
  Alarm inhibit_;
};

}  // namespace simulator
