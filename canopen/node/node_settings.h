#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/clock.h"
#include "canopen/node/emcy.h"
#include "canopen/object.h"
#include "canopen/sdo/sdo_settings.h"

// What the master has to know of one node, as plain values. A profile and a site's configuration fill it.

namespace canopen {

/// What to do at boot with a setting that the drive should have.
enum class SetupPolicy : std::uint8_t {
  write,   ///< Make it so; only what differs is written, and read back.
  verify,  ///< Read it; another value is a boot error (letter J).
  assume   ///< Neither: the documented default holds, and lengths are checked on arrival.
};

/// Who fills a field of an RPDO.
enum class FieldUse : std::uint8_t {
  commanded,  ///< A writable signal names it.
  unused,     ///< The site declares it unused: sent as 0.
  unnamed     ///< Neither: the RPDO is never sent, writes go by SDO.
};

struct MappedObject {
  ObjectAddress object{};  ///< Index 0x0001..0x0007: a dummy (CiA 301 §7.4.7), skipped.
  DataType type = DataType::u16;
  std::uint8_t bits = 16;              ///< As mapped, 1..64.
  FieldUse use = FieldUse::commanded;  ///< RPDOs only.
  friend bool operator==(const MappedObject&, const MappedObject&) = default;
};

/// CiA 301 §7.4.7.1: an index 0x0001..0x0007 in a mapping stands for a gap as wide as the data type of that number.
[[nodiscard]] constexpr bool is_dummy(ObjectAddress object) noexcept {
  return object.index >= 0x0001 && object.index <= 0x0007;
}

/// A gap carries nothing, so nobody needs to command it.
[[nodiscard]] constexpr bool is_commanded(const MappedObject& mapped) noexcept {
  return mapped.use == FieldUse::commanded && !is_dummy(mapped.object);
}
[[nodiscard]] constexpr bool is_unnamed(const MappedObject& mapped) noexcept {
  return mapped.use == FieldUse::unnamed && !is_dummy(mapped.object);
}

/// One TPDO or RPDO (the drive's point of view).
struct PdoSettings {
  std::uint16_t number = 1;  ///< 1..512: communication object 0x1800/0x1400 + number - 1.
  std::uint32_t cob_id = 0;  ///< 11 bits, without flags.
  SetupPolicy communication = SetupPolicy::write;
  SetupPolicy mapping_policy = SetupPolicy::write;
  std::optional<std::uint8_t> transmission_type{};  ///< Nothing: left as the drive has it.
  std::optional<std::uint16_t> inhibit_time{};      ///< Sub 3 as the device counts it (CiA 301: 100 us).
  std::optional<std::uint16_t> event_timer{};       ///< Sub 5 in ms.
  /// RPDO: somebody relies on it, so it must be written (whatever `communication` says, but for verify) and read back.
  bool event_timer_required = false;
  std::vector<MappedObject> mapping{};  ///< At most 64 bits in all.
  /// TPDO: how often it comes (event timer or n SYNCs); zero: on change. Freshness hangs on it.
  Duration period{};
  /// What the device counts its inhibit time in (sub 3).
  Duration inhibit_unit = std::chrono::microseconds(100);
  /// TPDO on change: two never come closer to each other (its inhibit time); zero: no such limit is known.
  Duration shortest_period{};
  friend bool operator==(const PdoSettings&, const PdoSettings&) = default;
};

/// An RPDO whose reception the node supervises (its event timer, CiA 301 §7.5.2.35) is repeated this often once it was
/// commanded: two repetitions may be lost before the event timer runs out. Zero: not repeated.
[[nodiscard]] constexpr Duration repeat_time(const PdoSettings& rpdo) noexcept {
  constexpr int kRepeatsPerEventTimer = 3;
  constexpr Duration kFastestRepeat = std::chrono::milliseconds(5);
  const Duration event_timer = std::chrono::milliseconds(rpdo.event_timer.value_or(0));
  return event_timer == Duration::zero() ? Duration::zero()
                                         : std::max(event_timer / kRepeatsPerEventTimer, kFastestRepeat);
}

/// Object 0x1000 and 0x1018 as they must be; nothing: not compared, nor read.
struct ExpectedIdentity {
  std::optional<std::uint32_t> device_type{};
  std::optional<std::uint32_t> vendor{};
  std::optional<std::uint32_t> product{};
  std::optional<std::uint32_t> revision{};
  std::optional<std::uint32_t> serial{};
  friend bool operator==(const ExpectedIdentity&, const ExpectedIdentity&) = default;
};

/// How the master learns that a node lives (CiA 301 §7.2.8.2).
enum class ErrorControlKind : std::uint8_t {
  heartbeat,
  guarding,  ///< It answers requests of ours.
  none       ///< Neither, by choice: its TPDOs and SDO answers have to do.
};

struct ErrorControlSettings {
  SetupPolicy policy = SetupPolicy::write;                       ///< Of 0x1017.
  Duration heartbeat = std::chrono::milliseconds(500);           ///< Producer time written to 0x1017, whole ms.
  Duration heartbeat_timeout = std::chrono::milliseconds(1500);  ///< Silence that means loss, of whatever kind.
  Duration guarding{};  ///< >0: period of guarding requests, whole ms; there is no heartbeat then.
  /// >0: the node is to notice when we are gone: written to 0x1016 with the gateway's node id, with guarding as life
  /// guarding to 0x100C and 0x100D. Zero: these are untouched.
  Duration supervise_gateway{};
  bool has_guarding = false;  ///< Answers one guarding request when its state is searched for.
  friend bool operator==(const ErrorControlSettings&, const ErrorControlSettings&) = default;
};

[[nodiscard]] constexpr ErrorControlKind kind_of(const ErrorControlSettings& control) noexcept {
  if (control.heartbeat_timeout <= Duration::zero()) {
    return ErrorControlKind::none;
  }
  if (control.guarding > Duration::zero()) {
    return ErrorControlKind::guarding;
  }
  return control.heartbeat > Duration::zero() ? ErrorControlKind::heartbeat : ErrorControlKind::none;
}

/// A truth about the motor that one object tells: (value & mask) is one of `values`, or, with `negative`, the value as
/// a signed number is below zero.
struct MotorSign {
  ObjectAddress object{};
  DataType type = DataType::u16;
  Raw mask = ~Raw{0};
  std::vector<Raw> values{};
  bool negative = false;
  friend bool operator==(const MotorSign&, const MotorSign&) = default;
};

/// A raw value of the control command that only ever stops: (value & mask) == equals.
struct StopWord {
  Raw mask = ~Raw{0};
  Raw equals = 0;
  friend bool operator==(const StopWord&, const StopWord&) = default;
};

/// What is read of a node by SDO before something is done that a turning motor, or one that is about to turn, forbids.
/// Nothing: the profile names no such object.
struct MotorSigns {
  std::optional<MotorSign> running{};
  std::optional<MotorSign> fault{};
  std::optional<ObjectAddress> control{};  ///< The control command, as the node holds it.
  DataType control_type = DataType::u16;
  std::vector<StopWord> stops{};  ///< Exact values, in their order, before masks.
  friend bool operator==(const MotorSigns&, const MotorSigns&) = default;
};

/// The control command only ever stops.
[[nodiscard]] inline bool is_stop(const MotorSigns& motor, Raw control) noexcept {
  return std::any_of(motor.stops.begin(), motor.stops.end(),
                     [control](const StopWord& stop) { return (control & stop.mask) == stop.equals; });
}

/// The first exact value that only ever stops, as the control command's type holds it; nothing where none is known.
[[nodiscard]] inline std::optional<Raw> first_stop(const MotorSigns& motor) noexcept {
  const Raw width = ~Raw{0} >> (64U - bit_length(motor.control_type));
  const auto exact = std::find_if(motor.stops.begin(), motor.stops.end(),
                                  [width](const StopWord& stop) { return (stop.mask & width) == width; });
  return exact == motor.stops.end() ? std::nullopt : std::optional(normalise(motor.control_type, exact->equals));
}

struct NodeSettings {
  std::uint8_t node = 1;            ///< 1..127
  std::uint8_t gateway_node = 127;  ///< 0: none. For 0x1016.
  Duration gateway_heartbeat{};     ///< Period of the gateway's own heartbeat; zero: it sends none.
  ExpectedIdentity identity{};
  ErrorControlSettings error_control{};
  SdoSettings sdo{};
  EmcySettings emcy{};
  std::vector<PdoSettings> tpdos{};
  std::vector<PdoSettings> rpdos{};
  std::vector<ObjectValue> setup{};  ///< Further objects to make so at every boot, in this order.
  bool reconfigure_running = false;  ///< Change an operational drive that differs; else it is left alone (letter L).
  bool self_starting = false;  ///< Goes operational by itself after power-up: sent pre-operational once per boot-up.
  bool restart = false;        ///< Configured and started again after it left operational by itself.
  MotorSigns motor{};
  friend bool operator==(const NodeSettings&, const NodeSettings&) = default;
};

}  // namespace canopen
