#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "bridges/alarms/alarm_id.h"
#include "bridges/alarms/alarm_record.h"
#include "bridges/alarms/control_alarm.h"
#include "bridges/alarms/data_problem.h"
#include "bridges/alarms/error_list.h"
#include "canopen/clock.h"
#include "canopen/node/emcy.h"
#include "canopen/node/node_events.h"
#include "config/model.h"

namespace alarms {

/// All alarms of one drive. Tells `changed` of each alarm that looks different, in the same call.
///
/// After the gateway's start an alarm is what restore() says of it, not confirmed, and without that not known, until it
/// is decided: what the drive tells is active decides it, its end is decided
///  - emcy: as ErrorList says; without memory when the drive was asked for its errors, or found missing;
///  - heartbeat, boot: when the drive was booted, taken over, or found missing or not bootable;
///  - data: when all that the drive is to send came, or it is found not to be operational;
///  - control: as heartbeat and boot; but where it was active, and the drive can be commanded at all, by the next
///  command
///    that writes `control_command`.
class DriveAlarms {
 public:
  using Changed = std::function<void(AlarmKind kind)>;

  /// `model` outlives it.
  DriveAlarms(const config::Drive& model, Changed changed, const NewId& new_id = random_id);

  using FaultBegan = std::function<void(AlarmKind kind, canopen::TimePoint at)>;

  /// Told of each fault that becomes active, before `changed` and in the same call; it may call set_first(). `at`: when
  /// the frame came that told of it; of the other kinds than emcy when it was noticed. Not told of what is restored.
  void on_fault_began(FaultBegan began) { fault_began_ = std::move(began); }
  /// Alarm::first of the present activation.
  void set_first(AlarmKind kind, bool first, canopen::WallTime wall);
  /// Alarm::record of the present activation, or of the last one.
  void set_record(AlarmKind kind, std::string name);

  /// As it was before our start. Before all else; nothing for a drive that is out of service. What was over is not
  /// told.
  void restore(AlarmKind kind, const Alarm& before);

  void on_emcy(const canopen::Emcy& emcy, canopen::TimePoint at, canopen::WallTime wall);
  void on_bit(config::Severity severity, bool set, canopen::Duration period, canopen::TimePoint at,
              canopen::WallTime wall);
  /// The value of the bit is too old to tell anything.
  void on_stale_bit(config::Severity severity, canopen::TimePoint at);
  void on_fault_code(std::uint64_t code, canopen::WallTime wall);
  void on_readings(const ErrorReadings& readings, canopen::TimePoint at, canopen::WallTime wall);
  /// 0x1001 alone, which raises nothing.
  void on_error_register(const ErrorReadings& readings, canopen::TimePoint at, canopen::WallTime wall);
  /// The drive's boot-up message came.
  void on_boot_up(canopen::TimePoint at, canopen::WallTime wall);
  /// Heartbeat and boot alarms, and whether the emergencies are confirmed.
  void on_status(const canopen::NodeStatus& status, canopen::WallTime wall);
  /// What is wrong with values and emergencies; none: nothing. The first one gives the reason. Not to be called before
  /// the drive was looked at.
  void on_data_problems(const std::vector<DataProblem>& problems, canopen::WallTime wall);
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
  [[nodiscard]] const ErrorList& error_list() const noexcept { return errors_; }
  /// An error of this severity is active.
  [[nodiscard]] bool any(config::Severity severity) const noexcept;

 private:
  [[nodiscard]] AlarmRecord& record(AlarmKind kind) noexcept { return records_[static_cast<std::size_t>(kind)]; }
  [[nodiscard]] bool decided(AlarmKind kind) const noexcept { return decided_.test(static_cast<std::size_t>(kind)); }
  void decide(AlarmKind kind) noexcept { decided_.set(static_cast<std::size_t>(kind)); }
  void decide_emcy_if_asked() noexcept;
  void show_emcy(canopen::WallTime wall, canopen::TimePoint at = canopen::Clock::now());
  void show_data(canopen::WallTime wall);
  void end_control(canopen::WallTime wall);
  void show(AlarmKind kind, bool active, std::string_view reason, std::string text, canopen::WallTime wall);
  void tell(AlarmKind kind, canopen::TimePoint at);

  const config::Drive& model_;
  Changed changed_;
  FaultBegan fault_began_;
  std::optional<AlarmKind> telling_;  ///< `changed` is told of it as soon as its flag is known.
  ErrorList errors_;
  std::array<AlarmRecord, kAlarmKinds.size()> records_;
  std::bitset<kAlarmKinds.size()> decided_;
  bool awaits_command_ = false;  ///< Memory holds `control` active: a command ends it.
  bool asked_ = false;           ///< For its errors, since our start.
  bool bit_told_ = false;        ///< A fault or warning bit was received.
  std::string_view data_reason_;
  std::string data_;  ///< What is wrong with values and emergencies, as last told.
};

}  // namespace alarms
