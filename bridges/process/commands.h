#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridges/process/command.h"
#include "bridges/process/command_journal.h"
#include "bridges/process/command_lane.h"
#include "bridges/process/commanded.h"
#include "bridges/process/control.h"
#include "bridges/process/image.h"
#include "bridges/process/pending_command.h"
#include "bridges/process/write_plan.h"
#include "bridges/process/writer.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/event.h"
#include "canopen/nmt.h"
#include "canopen/node/node_events.h"
#include "canopen/object.h"
#include "canopen/wake_up.h"
#include "config/model.h"

namespace canopen {
class RemoteNode;
}

namespace process {

/// The arbiter: every command to one drive, whatever its way, passes here. In this order: writer allowed, expired,
/// lease, access, type, range, drive reachable; then in order of arrival by RPDO or SDO; then the outcome, at the
/// latest when the drive's deadline has passed since the arrival. Nothing is stored for later and nothing sent twice.
///
/// A stop (a `control_command` of the profile's `stop` values) waits for nobody but other stops: what writes
/// `control_command` and is older is superseded by it and never sent, and everything else lets it go first. It alone
/// may be sent twice.
///
/// Parts: commands.cpp the ways in, the order and the answers; commands_checks.cpp what is said of a command at its
/// arrival and while it waits; commands_steps.cpp how one is carried out, and what makes it void; commands_stop.cpp
/// stops; commands_control.cpp leases and time-outs; commands_objects.cpp any object by SDO.
class Commands {
 public:
  /// Told in the same call in which it happened.
  class Listener {
   public:
    /// A command of these signals, in order of position, was confirmed.
    virtual void on_commanded(std::span<const SignalId> signals) = 0;
    /// Holder, time-out or alarm of Control::state() changed.
    virtual void on_control() = 0;
    virtual void on_command_done(const CommandRecord& record, const Outcome& outcome) = 0;

   protected:
    ~Listener() = default;
  };

  /// All outlive it.
  Commands(boost::asio::any_io_executor executor, const config::Drive& model, canopen::RemoteNode& node,
           const Image& image, Listener& listener);

  /// Before the first command; null: none is kept. Outlives it.
  void set_journal(CommandJournal* journal) noexcept { journal_ = journal; }

  boost::asio::awaitable<Outcome> write(Origin origin, std::vector<FieldWrite> fields);
  /// The profile's first stop value; `unknown` where none is known.
  boost::asio::awaitable<Outcome> stop_motor(Origin origin);
  boost::asio::awaitable<Outcome> nmt(Origin origin, canopen::NmtCommand command);
  boost::asio::awaitable<canopen::Result<canopen::Raw>> sdo_read(canopen::ObjectAddress object, canopen::DataType type);
  boost::asio::awaitable<Outcome> sdo_write(Origin origin, canopen::ObjectValue value);
  boost::asio::awaitable<canopen::Result<std::vector<std::uint8_t>>> sdo_read(canopen::ObjectAddress object);
  boost::asio::awaitable<Outcome> sdo_write(Origin origin, canopen::ObjectAddress object,
                                            std::vector<std::uint8_t> data);
  /// A command that its bridge cannot take for one: it was asked for all the same, so log and journal have it. What is
  /// told: `mistake`, or what goes before it, which is the writer and, before access, type and range, the lease.
  /// `retained` stands before the writer. `kind`: what was asked for, as far as it can be told.
  Outcome refuse(Origin origin, CommandRecord::Kind kind, canopen::Error mistake);

  void on_status(const canopen::NodeStatus& status);
  void on_boot_up();
  /// A fault began, or a quick stop that nobody commanded: what was commanded before is neither to be sent again nor
  /// repeated.
  void on_fault_begin(std::string_view what);
  void on_fault_end();
  /// The motor came to a stop, or nobody can tell any more whether it turns.
  void on_standstill(std::string_view what);
  /// `running`: nothing where it is not fresh.
  void on_running(std::optional<bool> running);
  void on_taken_over();
  void on_sign_of_life(const Writer& writer);

  [[nodiscard]] const Commanded& commanded() const noexcept { return commanded_; }
  [[nodiscard]] ControlState control() const { return control_.state(); }
  [[nodiscard]] bool counts_on(const Writer& writer) const noexcept { return control_.counts_on(writer); }
  /// The `control_command` that counts is no stop, or one that is none is on its way, or may have been obeyed since the
  /// motor was `seen` to stand.
  [[nodiscard]] bool is_told_to_run(canopen::TimePoint seen) const;
  /// A command with these fields is a stop.
  [[nodiscard]] bool is_stop(std::span<const FieldWrite> fields) const;
  /// SDO abort code of the last command that the drive refused; 0: none, or superseded or void since.
  [[nodiscard]] std::uint32_t last_refused_abort() const noexcept { return last_refused_abort_; }
  /// Fields that the last write that failed had written before it failed.
  [[nodiscard]] std::size_t last_written() const noexcept { return last_written_; }

  /// Answers what is pending, and all that comes from now on, with `offline`.
  void close();
  boost::asio::awaitable<void> until_idle();

 private:
  /// Somebody who must have left before the owner goes.
  class Visit {
   public:
    explicit Visit(Commands& owner) : owner_(owner) { ++owner_.visits_; }
    ~Visit() {
      --owner_.visits_;
      owner_.changed_.notify();
    }
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

   private:
    Commands& owner_;
  };
  using Refusal = std::optional<canopen::Error>;

  // Arrival and order.
  [[nodiscard]] PendingCommand arrive(Origin origin, CommandRecord::Kind kind);
  void take_fields(PendingCommand& command, std::span<const FieldWrite> fields) const;
  [[nodiscard]] ControlUse use_of(std::span<const FieldWrite> fields) const;
  [[nodiscard]] ControlUse use_of_control(canopen::Raw word) const;
  /// Bits made a value of the word that stands now.
  [[nodiscard]] canopen::Result<std::vector<FieldWrite>> resolve(std::span<const FieldWrite> fields) const;
  /// The word that some bits of which are to be changed.
  [[nodiscard]] canopen::Result<canopen::Raw> base_of_bits(SignalId signal) const;
  [[nodiscard]] Refusal refuse_asker(const PendingCommand& command) const;
  [[nodiscard]] Refusal refuse_lease(const PendingCommand& command) const;
  [[nodiscard]] Refusal refuse_out_of_service() const;
  [[nodiscard]] Refusal refuse_unreachable() const;
  [[nodiscard]] Refusal refuse_older_than_stop(const PendingCommand& command) const;
  [[nodiscard]] Refusal refuse_waiting(const PendingCommand& command) const;
  [[nodiscard]] Refusal refuse_for_time(const PendingCommand& command) const;
  void accept(const PendingCommand& command);
  /// `fields`: what of it is accepted.
  void supersede_older(const PendingCommand& by, std::span<const Field> fields);
  boost::asio::awaitable<Outcome> write_in_turn(PendingCommand& command, std::vector<FieldWrite> given,
                                                const std::vector<FieldWrite>& resolved);
  /// A raw write of a signal's object in another type, or of other bytes.
  Outcome refuse_type(Origin origin, const canopen::ObjectValue& value, std::vector<std::uint8_t> bytes,
                      SignalId signal);
  /// `expected`: its bytes, where the drive does not tell them; 0: not known.
  boost::asio::awaitable<canopen::Result<std::vector<std::uint8_t>>> read_whole(canopen::ObjectAddress object,
                                                                                std::size_t expected);
  boost::asio::awaitable<Outcome> write_raw(Origin origin, canopen::ObjectValue value, std::vector<std::uint8_t> bytes);
  boost::asio::awaitable<Outcome> send_raw(PendingCommand& command);
  boost::asio::awaitable<Outcome> send_nmt(PendingCommand& command, canopen::NmtCommand nmt);
  boost::asio::awaitable<Refusal> await_turn(PendingCommand& command);
  /// `running`: nothing where nobody can tell.
  [[nodiscard]] Refusal refuse_nmt(canopen::NmtCommand command, std::optional<bool> running) const;
  /// The same for a command that has its turn. A drive that was left alone is asked whether its motor runs.
  boost::asio::awaitable<Refusal> refuse_nmt_now(canopen::NmtCommand command);
  void finish(const PendingCommand& command, Outcome& outcome);
  [[nodiscard]] canopen::Error error(canopen::ErrorKind kind, std::string detail) const;
  [[nodiscard]] canopen::Error closed_error() const;

  // Carrying out.
  boost::asio::awaitable<Outcome> carry_out(PendingCommand& command, std::vector<Field> remaining);
  boost::asio::awaitable<Outcome> take_step(PendingCommand& command, std::vector<Field>& remaining);
  boost::asio::awaitable<canopen::Result<void>> send_rpdo(PendingCommand& command, const WriteStep& step,
                                                          std::span<const Field> borrowed);
  boost::asio::awaitable<canopen::Result<void>> send_sdo(PendingCommand& command, const Field& field, bool as_stop);
  void account(PendingCommand& command, const WriteStep& step, Commanded::Epoch since,
               const canopen::Result<void>& result);
  void note_confirmed(PendingCommand& command, const Field& field, std::uint16_t rpdo);
  void take_out(PendingCommand& command, std::vector<Field>& fields, std::span<const Field> written);
  [[nodiscard]] canopen::Error explain(canopen::Error error, SignalId signal) const;
  /// Of a signal that goes by RPDO alone: what completes that.
  [[nodiscard]] canopen::Error incomplete(SignalId signal) const;
  boost::asio::awaitable<void> note_begin(PendingCommand& command);
  /// A stop came: the step under way is not sent where it has not left, and nothing of before it that moves a motor.
  void call_back();
  [[nodiscard]] bool holds_all(std::span<const Field> fields) const;
  void on_void();
  /// Whether the motor runs; nothing where nobody can tell.
  [[nodiscard]] std::optional<bool> running() const;
  /// The same; nothing also where a run command is newer than what says that the motor stands.
  [[nodiscard]] std::optional<bool> running_since_commanded() const;

  // Stops.
  /// What of a command that goes first is sent, `control_command` at the front, and why the rest of it is not.
  struct StopParts {
    std::vector<Field> fields;
    std::optional<canopen::Error> left_out;
  };
  boost::asio::awaitable<Outcome> overtake(PendingCommand& command, std::vector<FieldWrite> given);
  [[nodiscard]] StopParts take_apart(const PendingCommand& command, std::span<const FieldWrite> given) const;
  /// It writes that value to `control_command`, whatever stands beside it.
  [[nodiscard]] bool asks_control(const PendingCommand& command, canopen::Raw raw) const;
  void go_first(const PendingCommand& stop, canopen::Raw raw);
  /// A newer stop waits for this one. What is read to complete an equal one the newer one would have to read, too.
  void hurry(PendingCommand& older, const PendingCommand& newer, bool equal);
  [[nodiscard]] Refusal refuse_superfluous(const PendingCommand& stop) const;
  /// Its RPDO was handed over, with this result.
  void note_left(PendingCommand& stop, const canopen::Result<void>& sent);
  /// A stop that was not confirmed while an equal one waited behind it: the confirmation of that one is its own.
  boost::asio::awaitable<canopen::Result<void>> join_equal(PendingCommand& command, std::vector<Field>& fields,
                                                           canopen::Result<void> stopped);
  boost::asio::awaitable<Refusal> await_stop_turn(PendingCommand& command);
  boost::asio::awaitable<canopen::Result<void>> send_stop(PendingCommand& command, std::vector<Field>& fields);
  boost::asio::awaitable<canopen::Result<void>> stop_by_sdo(PendingCommand& command, std::vector<Field>& fields,
                                                            bool left_by_rpdo);
  /// The set-points beside a stop, or those that a time-out writes: they pass what waits, but are set-points.
  boost::asio::awaitable<Outcome> write_first(PendingCommand& command, std::vector<Field> fields);
  boost::asio::awaitable<canopen::Result<void>> complete_by_reading(PendingCommand& command,
                                                                    std::vector<Field>& fields);

  // Leases and time-outs.
  [[nodiscard]] static ControlSettings control_settings(const config::Commands& commands);
  void on_control_time();
  void control_changed();
  boost::asio::awaitable<void> write_timeout_values(std::unique_ptr<Visit> visit);

  boost::asio::any_io_executor executor_;
  const config::Drive& model_;
  canopen::RemoteNode& node_;
  const Image& image_;
  Listener& listener_;
  CommandJournal* journal_ = nullptr;

  Commanded commanded_;
  Control control_;
  ControlState told_;
  canopen::WakeUp control_time_;

  canopen::Event changed_;
  CommandLane lane_{changed_};
  CommandLane stops_{changed_};
  std::size_t visits_ = 0;
  bool closed_ = false;
  bool live_ = false;
  bool doubled_ = false;  ///< Two nodes have its node id.

  std::string id_prefix_;  ///< Of what the client gave no id: unique over restarts, so that the journal is found by it.
  std::uint64_t arrivals_ = 0;
  std::uint64_t last_stop_ = 0;                                       ///< Number of the newest stop.
  canopen::TimePoint last_stop_arrived_ = canopen::TimePoint::min();  ///< Of all stops the latest.
  std::string last_stop_text_;                                        ///< What it wrote.
  std::uint64_t last_left_stop_ = 0;  ///< The newest stop that is on the bus, or may be.
  std::uint32_t last_refused_abort_ = 0;
  std::size_t last_written_ = 0;
};

}  // namespace process
