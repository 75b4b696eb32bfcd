#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "bridges/process/commanded.h"
#include "tests/unit/process/test_drive.h"

// What was commanded, without a bus: who confirms what, and what became void meanwhile, is told by hand.
namespace process::commanded {

using canopen::ObjectValue;
using canopen::Raw;
/// Of one RPDO: control, frequency, torque; nothing: not repeated, or not complete.
using Frame = std::optional<std::vector<Raw>>;

inline constexpr Raw kRun = 1;
inline constexpr Raw kCoast = 5;  ///< The profile's first stop.
inline constexpr Raw kRamp = 6;
inline constexpr Raw kReset = 7;  ///< Acts as long as the drive sees it.
inline constexpr Raw kEdgeReset = 0x80;
inline constexpr canopen::Duration kTick = std::chrono::milliseconds(1);

/// RPDO1 carries control, frequency and torque, RPDO2 the limit; the drive supervises both.
inline config::Drive supervised_drive() {
  config::Drive drive = test::drive();
  config::Signal& control = drive.signals[test::id(drive, "control_command")];
  control.momentary = {kReset, kEdgeReset};
  control.edge = {kEdgeReset};
  drive.node.motor.stops = {{.equals = kCoast}, {.equals = kRamp}};
  drive.node.rpdos[0].event_timer = std::uint16_t{300};
  canopen::PdoSettings rpdo2 = drive.node.rpdos[0];
  rpdo2.number = 2;
  rpdo2.cob_id = 0x305;
  rpdo2.mapping = {{test::kLimit}};
  drive.node.rpdos.push_back(rpdo2);
  return drive;
}

/// What makes something void.
enum class Event : std::uint8_t { none, fault_begin, fault_end, standstill, stop_comes, session_end };

inline constexpr std::string_view to_string(Event event) {
  constexpr std::string_view kNames[] = {"none", "fault begin", "fault end", "standstill", "stop comes", "session end"};
  return kNames[static_cast<std::size_t>(event)];
}

class CommandedTest : public testing::Test {
 protected:
  explicit CommandedTest(config::Drive drive = supervised_drive()) : model_(std::move(drive)) {}

  [[nodiscard]] Field control(Raw raw) const { return {control_, raw}; }
  [[nodiscard]] Field frequency(Raw raw) const { return {frequency_, raw}; }
  [[nodiscard]] Field torque(Raw raw) const { return {torque_, raw}; }
  [[nodiscard]] Field limit(Raw raw) const { return {limit_, raw}; }
  [[nodiscard]] std::vector<Field> all(Raw word) const { return {control(word), frequency(3000), torque(7)}; }

  void confirm(const std::vector<Field>& fields, std::uint16_t rpdo) {
    confirm_since(commanded_.epoch(), fields, rpdo);
  }
  void confirm_since(Commanded::Epoch since, const std::vector<Field>& fields, std::uint16_t rpdo) {
    now_ += kTick;
    commanded_.confirm(fields, rpdo, since, true, now_);
  }
  /// All of RPDO1 has left.
  void by_rpdo(Raw word) { confirm(all(word), 1); }
  void by_sdo(const Field& field) { confirm({field}, 0); }
  void happens(Event event) {
    switch (event) {
      case Event::none:
        break;
      case Event::fault_begin:
        commanded_.on_fault_begin("a fault began");
        break;
      case Event::fault_end:
        commanded_.on_fault_end();
        break;
      case Event::standstill:
        commanded_.on_standstill("the motor came to a stop");
        break;
      case Event::stop_comes:
        commanded_.on_stop(kRamp);
        break;
      case Event::session_end:
        commanded_.on_session_end("it rebooted");
        break;
    }
  }
  [[nodiscard]] static Frame raw_of(const std::optional<std::vector<ObjectValue>>& values) {
    if (!values) {
      return std::nullopt;
    }
    std::vector<Raw> raw;
    for (const ObjectValue& value : *values) {
      raw.push_back(value.raw);
    }
    return raw;
  }
  [[nodiscard]] Frame repeated(std::uint16_t rpdo = 1) const { return raw_of(commanded_.repetition(rpdo)); }
  [[nodiscard]] Frame completed(const std::vector<Field>& given, std::uint16_t rpdo = 1) const {
    return raw_of(commanded_.values(rpdo, given));
  }

  config::Drive model_;
  SignalId control_ = test::id(model_, "control_command");
  SignalId frequency_ = test::id(model_, "frequency_command");
  SignalId torque_ = test::id(model_, "torque_command");
  SignalId limit_ = test::id(model_, "upper_limit");
  Commanded commanded_{model_};
  canopen::TimePoint now_{std::chrono::hours(1)};
};

}  // namespace process::commanded
