#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "bridges/alarms/alarm_id.h"
#include "bridges/alarms/alarm_record.h"
#include "bridges/alarms/control_alarm.h"
#include "bridges/alarms/emergencies.h"
#include "canopen/clock.h"
#include "canopen/node/emcy.h"
#include "canopen/node/node_events.h"
#include "config/model.h"

namespace alarms {

/// All alarms of one drive. Tells `changed` of each alarm that looks different, in the same call.
///
/// After the gateway's start an alarm is what restore() says of it, not confirmed, and without that not known, until it
/// is decided: what the drive tells is active decides it, its end is decided
///  - emcy: as Emergencies says; without memory when the drive was asked for its errors, or found missing;
///  - heartbeat, boot: when the drive was booted, taken over, or found missing or not bootable;
///  - data: when all that the drive is to send came, or it is found not to be operational;
///  - control: by the next command that writes `control_command`; without memory there is nothing to wait for.
class DriveAlarms {
 public:
  using Changed = std::function<void(AlarmKind kind)>;

  /// `model` outlives it.
  DriveAlarms(const config::Drive& model, Changed changed, const NewId& new_id = random_id);

  /// As it was before our start. Before all else; nothing for a drive that is out of service. What was over is not
  /// told.
  void restore(AlarmKind kind, const Alarm& before);

  void on_emcy(const canopen::Emcy& emcy, canopen::TimePoint at, canopen::WallTime wall);
  void on_bit(config::Severity severity, bool set, canopen::Duration period, canopen::TimePoint at,
              canopen::WallTime wall);
  void on_fault_code(std::uint64_t code, canopen::WallTime wall);
  void on_readings(const ErrorReadings& readings, canopen::TimePoint at, canopen::WallTime wall);
  /// Heartbeat and boot alarms, and whether the emergencies are confirmed.
  void on_status(const canopen::NodeStatus& status, canopen::WallTime wall);
  /// Texts of what is wrong with TPDOs; none: nothing.
  void on_data_problems(const std::vector<std::string>& problems, canopen::WallTime wall);
  /// Nothing: it is over.
  void on_control(const std::optional<ControlAlarm>& alarm, canopen::WallTime wall);
  /// Somebody commanded the motor, which ends what memory holds of `control`.
  void on_control_command(canopen::WallTime wall);
  /// The motor runs: `feedback` of before is over.
  void on_running(canopen::WallTime wall);
  /// All that the drive sends came, or long enough was waited for it.
  void on_settled(canopen::WallTime wall);
  /// Nothing decided for so long that nothing soon will: what is not known counts as not active.
  void on_patience_over(canopen::WallTime wall);

  [[nodiscard]] const Alarm& alarm(AlarmKind kind) const noexcept;
  [[nodiscard]] const Emergencies& emergencies() const noexcept { return emergencies_; }
  /// An error of this severity is active.
  [[nodiscard]] bool any(config::Severity severity) const noexcept;

 private:
  [[nodiscard]] AlarmRecord& record(AlarmKind kind) noexcept { return records_[static_cast<std::size_t>(kind)]; }
  [[nodiscard]] bool decided(AlarmKind kind) const noexcept { return decided_.test(static_cast<std::size_t>(kind)); }
  void decide(AlarmKind kind) noexcept { decided_.set(static_cast<std::size_t>(kind)); }
  void decide_emcy_if_asked() noexcept;
  void show_emcy(canopen::WallTime wall);
  void show_data(canopen::WallTime wall);
  void end_control(canopen::WallTime wall);
  void show(AlarmKind kind, bool active, std::string text, config::Severity severity, canopen::WallTime wall);

  const config::Drive& model_;
  Changed changed_;
  Emergencies emergencies_;
  std::array<AlarmRecord, kAlarmKinds.size()> records_;
  std::bitset<kAlarmKinds.size()> decided_;
  bool asked_ = false;     ///< For its errors, since our start.
  bool bit_told_ = false;  ///< A fault or warning bit was received.
  std::string data_;       ///< What is wrong with TPDOs, as last told.
};

}  // namespace alarms
