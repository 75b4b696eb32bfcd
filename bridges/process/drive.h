#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "bridges/alarms/drive_alarms.h"
#include "bridges/process/command.h"
#include "bridges/process/commands.h"
#include "bridges/process/image.h"
#include "bridges/process/inputs.h"
#include "bridges/process/observer.h"
#include "bridges/process/reader.h"
#include "bridges/process/settling.h"
#include "bridges/process/writer.h"
#include "canopen/error.h"
#include "canopen/nmt.h"
#include "canopen/node/node_events.h"
#include "canopen/node/remote_node.h"
#include "canopen/wake_up.h"
#include "config/model.h"

namespace canopen {
class Bus;
}

namespace process {

/// Whether the motor of a drive turns, as far as anybody can tell.
enum class Turning : std::uint8_t {
  no,       ///< Or the drive is offline: nothing is known of it.
  yes,      ///< `running` says so, or it was commanded to and nothing has ended that.
  unknown,  ///< The drive is online, and `running` is not fresh.
  untold    ///< Its profile has no `running`.
};

/// One drive as the bridges see it: its model, its image, its alarms, its status, and the one way for commands. What
/// its remote node tells it hands to inputs, alarms and commands, and what changes to the observers.
class Drive final : private canopen::NodeEvents, private Inputs::Listener, private Commands::Listener {
 public:
  /// `model`, `bus` and `observers` outlive the drive; `observers` may grow until start().
  Drive(const boost::asio::any_io_executor& executor, const config::Drive& model, std::size_t index, canopen::Bus& bus,
        const std::vector<Observer*>& observers);
  virtual ~Drive() = default;
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  /// A drive that is out of service (config::Drive::enabled) stays as it is now: offline, without values and alarms,
  /// and every command is answered `offline`.
  void start();
  /// The end is near: commands that have not begun, and all that come from now on, are answered `offline`; a drive that
  /// is not in service is neither configured nor started any more.
  void close();
  /// Pending commands are answered `offline`. Sends nothing to the drive.
  boost::asio::awaitable<void> stop();

  [[nodiscard]] const config::Drive& model() const noexcept { return model_; }
  /// Position in config::Model::drives. Both change with the plant's model.
  [[nodiscard]] std::size_t index() const noexcept { return index_; }
  /// Position in config::Model::buses; that in model() is as it was when this drive was made.
  [[nodiscard]] std::size_t bus() const noexcept { return bus_; }
  void set_place(std::size_t index, std::size_t bus) noexcept {
    index_ = index;
    bus_ = bus;
  }
  /// It was left out of the plant: who still asks it something is answered, and no observer hears of that.
  void leave();
  [[nodiscard]] Turning turning() const;
  /// What a change of its configuration waits for, for people; empty: none waits.
  void set_pending_change(std::string waits_for);
  [[nodiscard]] const std::string& pending_change() const noexcept { return pending_change_; }
  [[nodiscard]] const Image& image() const noexcept { return image_; }
  [[nodiscard]] const canopen::NodeStatus& status() const noexcept { return node_.status(); }
  [[nodiscard]] const alarms::Alarm& alarm(alarms::AlarmKind kind) const noexcept { return alarms_.alarm(kind); }
  /// SDO transfers that it refused since the start.
  [[nodiscard]] const canopen::AbortCounts& sdo_aborts() const noexcept { return node_.sdo_aborts(); }
  /// Any alarm of a fault's severity is active / of a warning's.
  [[nodiscard]] bool has_fault_alarm() const noexcept { return alarms_.any(config::Severity::fault); }
  [[nodiscard]] bool has_warning_alarm() const noexcept { return alarms_.any(config::Severity::warning); }

  /// Writes signals, checked altogether before anything is sent (writer, access, type, range, drive reachable), then by
  /// RPDO or SDO. Confirmed when it returns a value. The error's detail names what was already written.
  boost::asio::awaitable<Outcome> write(Origin origin, std::vector<FieldWrite> fields) {
    return commands_.write(std::move(origin), std::move(fields));
  }
  /// The profile's first stop value; `unknown` where none is known.
  boost::asio::awaitable<Outcome> stop_motor(Origin origin) { return commands_.stop_motor(std::move(origin)); }
  boost::asio::awaitable<Outcome> nmt(Origin origin, canopen::NmtCommand command) {
    return commands_.nmt(std::move(origin), command);
  }
  /// Any object. A read needs no writer's permission, and is a `type` error where the drive answers fewer bytes,
  /// or more that say something; a write of an object that is no writable signal needs `raw`, and
  /// one that is goes the signal's way with its limits.
  boost::asio::awaitable<canopen::Result<canopen::Raw>> sdo_read(canopen::ObjectAddress object,
                                                                 canopen::DataType type) {
    return commands_.sdo_read(object, type);
  }
  boost::asio::awaitable<Outcome> sdo_write(Origin origin, canopen::ObjectValue value) {
    return commands_.sdo_write(std::move(origin), value);
  }
  /// The same with the bytes that SDO carries, lowest first, whatever they mean: an object whole, at least one byte.
  boost::asio::awaitable<canopen::Result<std::vector<std::uint8_t>>> sdo_read(canopen::ObjectAddress object) {
    return commands_.sdo_read(object);
  }
  boost::asio::awaitable<Outcome> sdo_write(Origin origin, canopen::ObjectAddress object,
                                            std::vector<std::uint8_t> data) {
    return commands_.sdo_write(std::move(origin), object, std::move(data));
  }
  /// A command that a bridge refuses by itself: noted as one, and what is to be told. The writer, and before access,
  /// type and range the lease, go before `mistake`, unless that is `retained`.
  Outcome refuse(Origin origin, CommandRecord::Kind kind, canopen::Error mistake) {
    return commands_.refuse(std::move(origin), kind, std::move(mistake));
  }

  /// A command with these fields is a stop: nothing may keep it waiting. Where none of them changes bits alone (Mask),
  /// from any thread: it looks at the model only.
  [[nodiscard]] bool is_stop(std::span<const FieldWrite> fields) const { return commands_.is_stop(fields); }
  [[nodiscard]] const Commanded& commanded() const noexcept { return commands_.commanded(); }
  [[nodiscard]] ControlState control() const { return commands_.control(); }
  /// It may run, and its command timeout acts where `writer` falls silent.
  [[nodiscard]] bool counts_on(const Writer& writer) const noexcept { return commands_.counts_on(writer); }
  /// SDO abort code of the last command that the drive refused; 0: none, or one was superseded or void since.
  [[nodiscard]] std::uint32_t last_refused_abort() const noexcept { return commands_.last_refused_abort(); }
  /// Fields that the last write that failed had written before it failed.
  [[nodiscard]] std::size_t last_written() const noexcept { return commands_.last_written(); }
  /// Somebody who may command this drive shows that he is there.
  void sign_of_life(const Writer& writer) { commands_.on_sign_of_life(writer); }
  /// Something of a bridge about this drive that a person should know: for the log.
  void remark(const std::string& text) { on_remark(text); }
  /// Before start(); null: none is kept. Outlives the drive.
  void set_journal(CommandJournal* journal) noexcept { commands_.set_journal(journal); }

  /// Before start(), see alarms::DriveAlarms.
  void on_fault_began(alarms::DriveAlarms::FaultBegan began) { alarms_.on_fault_began(std::move(began)); }
  /// NodeStatus::doubled is another one.
  void on_doubled_change(std::function<void()> changed) { doubled_changed_ = std::move(changed); }
  void set_first(alarms::AlarmKind kind, bool first) { alarms_.set_first(kind, first, canopen::wall_now()); }
  void set_record(alarms::AlarmKind kind, std::string name) { alarms_.set_record(kind, std::move(name)); }

  /// As it was before our start, see alarms::DriveAlarms. Before start().
  void restore(alarms::AlarmKind kind, const alarms::Alarm& before) { alarms_.restore(kind, before); }

 private:
  // canopen::NodeEvents
  void on_status(const canopen::NodeStatus& status) override;
  void on_boot_up() override;
  void on_arrival(canopen::Arrival arrival) override;
  void on_tpdo(std::uint16_t number, std::span<const canopen::Raw> values, canopen::TimePoint at,
               canopen::WallTime wall) override;
  void on_tpdo_length(std::uint16_t number, std::size_t expected, std::size_t received) override;
  void on_start_ignored() override { reader_.check_errors(); }
  void on_emcy(const canopen::Emcy& emcy, canopen::TimePoint at, canopen::WallTime wall) override;
  void on_emcy_checked(const canopen::EmcyVerdict& verdict) override;
  void on_frames_lost() override;
  std::optional<std::vector<canopen::ObjectValue>> repetition(std::uint16_t rpdo) override {
    return commands_.commanded().repetition(rpdo);
  }

  // Inputs::Listener
  void on_values(SourceId source) override;
  void on_stale(SourceId source) override;
  void on_watch_failed(SourceId source) override;
  void on_presence(SourceId source) override;
  void on_problems() override;
  void on_remark(const std::string& text) override;  ///< Of both.
  void on_read_wanted() override;

  // Commands::Listener
  void on_commanded(std::span<const SignalId> signals) override;
  void on_control() override;
  void on_command_done(const CommandRecord& record, const Outcome& outcome) override;

  /// A signal that decides on alarms and on what may be sent again.
  struct Indicator {
    SignalId signal;
    SourceId source;
  };
  [[nodiscard]] std::optional<Indicator> indicator(const std::optional<std::size_t>& signal) const;
  [[nodiscard]] bool is_from(const std::optional<Indicator>& indicator, SourceId source) const noexcept {
    return indicator && indicator->source == source;
  }
  void void_commands(SourceId source);
  void tell_running(std::optional<bool> running);
  void on_quick_stop();
  void tell_alarms(SourceId source);
  void tell_bit(const std::optional<Indicator>& indicator, config::Severity severity, SourceId source);
  void tell_stale_bit(const std::optional<Indicator>& indicator, config::Severity severity, SourceId source);
  void watch_bits(canopen::TimePoint now);
  void arm_expiry();
  template <class Tell>
  void tell(Tell tell_one) const;

  const config::Drive& model_;
  std::size_t index_;
  std::size_t bus_;
  std::string pending_change_;
  const std::vector<Observer*>* observers_;
  Image image_;
  canopen::RemoteNode node_;
  Inputs inputs_;
  alarms::DriveAlarms alarms_;
  Commands commands_;
  Reader reader_;
  canopen::WakeUp expiry_;
  canopen::TimePoint expiry_for_ = canopen::kNever;  ///< What it is set for.
  Settling settling_;

  std::optional<Indicator> fault_;
  std::optional<Indicator> warning_;
  std::optional<Indicator> running_;
  std::optional<Indicator> quick_stop_;
  std::optional<Indicator> fault_code_;
  std::optional<bool> told_running_;  ///< Nothing: not fresh.
  bool was_running_ = false;
  bool had_fault_ = false;
  /// An emergency of a fault came, and none that tells its end. Nothing: nobody knows what was missed.
  std::optional<bool> had_fault_emcy_;
  bool had_quick_stop_ = false;
  std::optional<alarms::DataProblem> emcy_problem_;
  bool data_known_ = false;  ///< The drive itself has told what is wrong with its data, or that nothing is.
  bool was_online_ = false;
  canopen::Doubled told_doubled_ = canopen::Doubled::no;
  std::function<void()> doubled_changed_;
};

}  // namespace process
