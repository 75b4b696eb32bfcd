#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "bridges/alarms/drive_alarms.h"
#include "tests/unit/process/test_drive.h"

namespace alarms {

/// The alarms of one drive, fed by hand with emergencies, bits, readings and time.
class AlarmsTest : public ::testing::Test {
 protected:
  using Duration = canopen::Duration;
  using Severity = config::Severity;
  using TimePoint = canopen::TimePoint;
  using WallTime = canopen::WallTime;

  AlarmsTest() { build(); }

  void build() {
    alarms_ = std::make_unique<DriveAlarms>(
        model_, [this](AlarmKind kind) { told_.push_back(kind); }, [this] { return "id" + std::to_string(++ids_); });
    told_.clear();
  }

  void come_online() {
    status_.online = true;
    status_.configured = true;
    status_.lost = false;
    status_.nmt = canopen::NmtState::operational;
    status_.boot_result = canopen::BootResult::ok;
    alarms_->on_status(status_, wall_);
  }
  void go_offline(bool lost = true) {
    status_.online = false;
    status_.lost = lost;
    alarms_->on_status(status_, wall_);
  }
  /// 0x1001 is to be read.
  [[nodiscard]] bool undecided() const { return alarms_->error_list().undecided_since().has_value(); }
  void pass(Duration time) {
    now_ += time;
    wall_ += time;
  }

  void emcy(std::uint16_t code, std::uint8_t error_register = 0x01, std::array<std::uint8_t, 5> vendor = {}) {
    std::array<std::uint8_t, 8> bytes{static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8),
                                      error_register};
    std::copy(vendor.begin(), vendor.end(), bytes.begin() + 3);
    alarms_->on_emcy(canopen::decode_emcy(model_.node.emcy, bytes).value(), now_, wall_);
  }
  void reset(std::uint8_t error_register = 0, std::uint8_t remaining = 0) { emcy(0, error_register, {remaining}); }
  void fault(bool set) { alarms_->on_bit(Severity::fault, set, process::test::kPeriod, now_, wall_); }
  void warning(bool set) { alarms_->on_bit(Severity::warning, set, process::test::kPeriod, now_, wall_); }
  /// What is found at an arrival, asked for and answered now.
  void readings(ErrorReadings readings) {
    readings.asked = now_;
    alarms_->on_readings(readings, now_, wall_);
  }
  /// 0x1001 alone, asked for `ago`.
  void reads(std::uint8_t error_register, Duration ago = {}) {
    alarms_->on_error_register({.asked = now_ - ago, .error_register = error_register}, now_, wall_);
  }
  void build_without_following_register() {
    model_.faults.error_register_follows = false;
    build();
  }

  [[nodiscard]] const Alarm& emcy_alarm() const { return alarms_->alarm(AlarmKind::emcy); }
  [[nodiscard]] std::vector<std::uint16_t> codes() const {
    std::vector<std::uint16_t> codes;
    for (const AlarmError& error : emcy_alarm().errors) {
      codes.push_back(error.code);
    }
    return codes;
  }
  using Codes = std::vector<std::uint16_t>;

  config::Drive model_ = process::test::drive();
  canopen::NodeStatus status_;
  std::unique_ptr<DriveAlarms> alarms_;
  std::vector<AlarmKind> told_;
  int ids_ = 0;  ///< Given.
  TimePoint now_{std::chrono::hours(1)};
  WallTime wall_{std::chrono::seconds(1000)};
};

}  // namespace alarms
