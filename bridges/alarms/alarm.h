#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/clock.h"
#include "config/model.h"

namespace alarms {

enum class AlarmKind : std::uint8_t {
  emcy,       ///< Emergency messages, or the fault signal without one.
  heartbeat,  ///< Error control lost, or a drive that never appeared.
  boot,       ///< It answers but cannot be configured or taken over, or left operational by itself.
  data,       ///< A TPDO is missing, the drive lacks an object, or its emergencies are switched off.
  control     ///< A command timeout acted or could not act.
};
inline constexpr std::array<AlarmKind, 5> kAlarmKinds{AlarmKind::emcy, AlarmKind::heartbeat, AlarmKind::boot,
                                                      AlarmKind::data, AlarmKind::control};
/// `emcy`, `heartbeat`, `boot`, `data`, `control`: the topic's last level.
[[nodiscard]] std::string_view name_of(AlarmKind kind) noexcept;
/// `fault`, `warning`
[[nodiscard]] std::string_view name_of(config::Severity severity) noexcept;

/// One error of a drive: one by code and vendor bytes.
struct AlarmError {
  std::uint16_t code = 0;
  std::array<std::uint8_t, 5> vendor{};
  std::string text;
  config::Severity severity = config::Severity::fault;
  canopen::WallTime since{};
  friend bool operator==(const AlarmError&, const AlarmError&) = default;
};

/// The state of one alarm, as every bridge shows it.
struct Alarm {
  bool active = false;
  std::string id;  ///< New at each change from inactive to active; empty before the first.
  /// Of the newest active error, a fault before a warning; while inactive, of the last one shown.
  std::uint16_t code = 0;
  std::string reason;  ///< Of the kinds without a code: a word of the closed list in docs/ALARMS.md; else empty.
  std::string text;
  config::Severity severity = config::Severity::fault;
  std::uint8_t error_register = 0;
  std::array<std::uint8_t, 5> vendor{};
  canopen::WallTime since{};    ///< When it became active.
  canopen::WallTime ts{};       ///< Of its last change; `confirmed` alone is none.
  canopen::WallTime cleared{};  ///< When it became inactive; zero before it ever did.
  std::uint32_t count = 0;      ///< Activations.
  bool confirmed = true;        ///< False while the drive cannot tell whether it still holds.
  /// False: neither memory nor the drive has told yet whether it is active. Nobody is shown it until then.
  bool known = false;
  bool first = false;  ///< A fault that no other one, of all drives and buses, came shortly before.
  std::vector<AlarmError> errors;
  std::string record{};  ///< The log of frames around the beginning of this activation; empty: none that is kept.
  friend bool operator==(const Alarm&, const Alarm&) = default;
};

}  // namespace alarms
