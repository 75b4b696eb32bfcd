#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canopen/bus/subscription.h"
#include "canopen/bus/transmit_class.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/event.h"
#include "canopen/node/configure.h"
#include "canopen/node/doubled_watch.h"
#include "canopen/node/find_state.h"
#include "canopen/node/heartbeat_consumer.h"
#include "canopen/node/life_context.h"
#include "canopen/node/nmt_expectation.h"
#include "canopen/node/node_events.h"
#include "canopen/node/node_guarding.h"
#include "canopen/node/node_settings.h"
#include "canopen/node/outputs.h"
#include "canopen/node/pdo.h"
#include "canopen/node/restart.h"
#include "canopen/node/retry_pause.h"
#include "canopen/node/sdo_patience.h"
#include "canopen/sdo/abort_counts.h"
#include "canopen/sdo/client.h"
#include "canopen/sdo/stop_limit.h"

namespace canopen {

class Bus;
struct BusState;
struct Received;

/// A drive as the master sees it: one coroutine that finds it, inspects or configures it, starts and serves it, and
/// begins again when that life is over (live(), one page). The frame handlers only record what they hear and end the
/// life. One dead drive never delays another.
///
/// Parts: remote_node.cpp the life, remote_node_boot.cpp how it comes into service, remote_node_wait.cpp what it waits
/// for, remote_node_steps.cpp what belongs to a stage; remote_node_heard.cpp what is heard, remote_node_alive.cpp what
/// tells that it lives; remote_node_asked.cpp what is read and commanded, remote_node_nmt.cpp what it is told to be.
class RemoteNode {
 public:
  /// `bus` and `events` outlive the node.
  RemoteNode(boost::asio::any_io_executor executor, Bus& bus, NodeSettings settings, NodeEvents& events);
  ~RemoteNode() = default;
  RemoteNode(const RemoteNode&) = delete;
  RemoteNode& operator=(const RemoteNode&) = delete;

  void start();
  /// The end is near: a node that is not in service is neither configured nor started any more. Before stop().
  void close();
  /// Ends the supervision and fails what is pending with `offline`. Sends nothing.
  boost::asio::awaitable<void> stop();

  [[nodiscard]] const NodeSettings& settings() const noexcept { return settings_; }
  [[nodiscard]] const NodeStatus& status() const noexcept { return status_; }
  /// It is being compared with the settings, configured or started.
  [[nodiscard]] bool arriving() const noexcept {
    return stage_ == Stage::inspecting || stage_ == Stage::configuring || stage_ == Stage::starting;
  }
  /// What its bus received before this moment has been told. Behind the clock after a stall of the process, until what
  /// waited was read: nothing is overdue that may still come.
  [[nodiscard]] TimePoint heard_until() const;
  /// The drive confirmed (or was given) the transmission type and timers of this TPDO, so `period` can be relied on.
  [[nodiscard]] bool tpdo_verified(std::uint16_t number) const noexcept;

  /// SDO upload with retries. Refused as offline while the node does not answer SDOs at all, or is stopped.
  /// `due`: when it was to be done; of all that waits for its turn on a busy bus the earliest is next.
  boost::asio::awaitable<Result<Raw>> read(ObjectAddress object, DataType type, TimePoint due = Clock::now());
  /// The same of an object whole, see SdoClient::read_bytes().
  boost::asio::awaitable<Result<std::vector<std::uint8_t>>> read_bytes(ObjectAddress object, std::size_t expected);
  /// SDO download of a command: sent once, withdrawn when not begun by `deadline`, outcome unknown when begun and
  /// unconfirmed by then. One not begun when the drive leaves operational is withdrawn, too: `offline`.
  boost::asio::awaitable<Result<void>> write(ObjectAddress object, DataType type, Raw raw, TimePoint deadline);
  /// The same with at least one byte of any meaning.
  boost::asio::awaitable<Result<void>> write_bytes(ObjectAddress object, std::vector<std::uint8_t> data,
                                                   TimePoint deadline);
  /// SDO download of a stop (SdoClient::write_stop), whatever became of the node, as long as the bus is up. To one that
  /// is not online, configured and operational it is sent once; where no answer comes: `offline` with outcome_unknown,
  /// "sent, not confirmed". A boot that is under way goes on behind it.
  boost::asio::awaitable<Result<void>> write_stop(ObjectAddress object, DataType type, Raw raw, TimePoint deadline,
                                                  const StopLimit& limit = kNoStopLimit);
  /// An SDO download of `object` is under way or went unanswered: the drive may carry it out behind an RPDO.
  [[nodiscard]] bool may_still_act(ObjectAddress object) const noexcept { return sdo_.may_still_act(object); }
  /// Departure of an NMT command. Only `start` ends the refusal to start a drive that left operational; where the drive
  /// was not configured since, it is booted first, and the departure is that of the boot's NMT start; where it was left
  /// alone as it runs, it is looked at again first. `refused` with the reason where that ends in a letter. A boot that
  /// was begun goes on after the deadline, so the outcome is unknown then.
  boost::asio::awaitable<Result<void>> command(NmtCommand command, TimePoint deadline);
  /// Whether the motor runs, read by SDO now; nothing where that cannot be known.
  boost::asio::awaitable<std::optional<bool>> motor_runs();

  /// Sends the RPDO with `values`, one for each commanded field of it; confirmed by its departure. From then on it is
  /// repeated with what NodeEvents::repetition() tells, where the node supervises it.
  boost::asio::awaitable<Result<void>> send_rpdo(std::uint16_t number, std::vector<ObjectValue> values,
                                                 TransmitClass transmit_class, TimePoint deadline);
  /// What completes a stop by RPDO: see SdoClient::read_for_stop().
  boost::asio::awaitable<Result<Raw>> read_for_stop(ObjectAddress object, DataType type, TimePoint deadline,
                                                    const StopLimit& limit = kNoStopLimit);
  /// A stop by SDO is not waited for much longer: see SdoClient::hurry_stop().
  void hurry_stop(StopLimit& limit, TimePoint deadline) { sdo_.hurry_stop(limit, deadline); }
  /// The longest that this node took to confirm one of its newest writes.
  [[nodiscard]] Duration write_time() const noexcept { return sdo_.write_time(); }
  /// How often the node refused an SDO transfer since the start.
  [[nodiscard]] const AbortCounts& sdo_aborts() const noexcept { return aborts_; }
  /// The command under way, by RPDO or SDO, never leaves where it has not left yet.
  void withdraw_command();
  /// A command of `object` goes by SDO now: an RPDO that is repeated must not undo it meanwhile.
  void hold_repetition(ObjectAddress object) { outputs_.hold(object); }
  /// That write is over.
  void refresh_repetition(ObjectAddress object) { outputs_.refresh(object); }
  /// NodeEvents::repetition() tells something else than before.
  void repetition_changed() { outputs_.look_again(); }

 private:
  enum class Stage : std::uint8_t {
    searching,    ///< Its state is being learnt, or the bus is down.
    silent,       ///< It was not there.
    inspecting,   ///< It runs, and is being compared with the settings.
    configuring,  ///< It is being made so.
    starting,     ///< NMT start is on its way or has left; not seen operational yet.
    serving,
    waiting,  ///< For another try, or for somebody to put it right.
    held      ///< Not to be started; only looked after.
  };
  struct Tpdo {
    std::uint16_t number = 0;
    PdoPlan plan;
  };
  class NmtSending;
  enum class NmtGroup : std::uint8_t { all, starts, of_this_life };
  class Operation;
  /// An NMT start command that waits for the boot or the look that it asked for.
  struct StartRequest {
    std::optional<Result<void>> result;
  };
  /// NMT commands of a boot that have not left by then are given up; the boot is tried again.
  static constexpr Duration kNmtTime = std::chrono::seconds(1);

  // The life.
  boost::asio::awaitable<void> run();
  boost::asio::awaitable<void> live(Life& life);
  boost::asio::awaitable<void> bus_up(Life& life);
  boost::asio::awaitable<FoundState> find(Life& life);
  boost::asio::awaitable<BootReport> take_over(LifeContext context);
  boost::asio::awaitable<BootReport> boot(LifeContext context, FoundState found);
  boost::asio::awaitable<BootReport> start_node(LifeContext context);
  boost::asio::awaitable<bool> waits_on(Life& life);
  boost::asio::awaitable<void> serve(Life& life);
  boost::asio::awaitable<void> stay_silent(Life& life);
  boost::asio::awaitable<void> wait_for_answers(Life& life);
  boost::asio::awaitable<void> wait_for_retry(Life& life, BootReport report);
  boost::asio::awaitable<void> hold_back(Life& life, FoundState found);
  boost::asio::awaitable<void> read_for_sign_of_life(Life& life);
  static boost::asio::awaitable<void> pause(Life& life, TimePoint until);
  /// Until retry_at_, or until a node of which nothing comes unasked does not answer any more; and looks for a second
  /// node where there are signs of one.
  boost::asio::awaitable<void> pause_and_look(Life& life);

  // Its steps.
  [[nodiscard]] LifeContext context(Life& life) { return {bus_, sdo_, guarding_, settings_, heard_, half_done_, life}; }
  [[nodiscard]] bool to_be_held(FoundState found);
  [[nodiscard]] bool heartbeat_is_fresh() const;
  void forget_stale_signs();
  void enter(Stage stage);
  /// Its SDO server is silent so far, and its heartbeats come: they are watched by the period that they have.
  void watch_before_answers();
  /// Its heartbeat comes more slowly than it may, so it is lost again and again without being away.
  boost::asio::awaitable<bool> has_slow_heartbeat();
  /// Ends the life: what was queued for it is withdrawn, what is pending fails as offline, RPDOs are void.
  void end_life();
  void accept(const BootReport& report);
  void go_online(Arrival arrival);
  boost::asio::awaitable<bool> make_pre_operational(const LifeContext& context);
  /// It went operational by itself after its boot-up, and its motor stands: it may be made pre-operational.
  boost::asio::awaitable<bool> started_itself(const LifeContext& context);
  boost::asio::awaitable<std::string> why_not_to_restart(const LifeContext& context);
  boost::asio::awaitable<void> restart_if_due(Life& life);
  [[nodiscard]] TimePoint next_serial_read() const noexcept;
  boost::asio::awaitable<void> read_serial_if_doubled(Life& life);
  [[nodiscard]] bool without_error_control() const noexcept {
    return kind_of(settings_.error_control) == ErrorControlKind::none;
  }
  /// When a node without error control is to be read, so that it shows that it lives; kNever: not.
  [[nodiscard]] TimePoint next_look() const;
  void note_left_by_itself(NodeStatus& status) const;
  void note_out_of_service();
  static void note_not_booted(NodeStatus& status);
  /// Applies `change` to the status and tells it where a field but the heartbeat's time differs.
  template <class Change>
  void change_status(Change change);

  // What is heard.
  void subscribe();
  void on_error_control(const Received& received);
  void on_boot_up(TimePoint at);
  void on_heartbeat(NmtState state, TimePoint at);
  void on_single_guarding_answer(NmtState state, TimePoint at);
  void on_guarding_answer(NmtState state, bool toggle, TimePoint at);
  /// Of a node without error control.
  void on_sign_of_life(TimePoint at);
  void take_state(NmtState state, StateMeaning meaning);
  [[nodiscard]] bool ends_life(NmtState state, StateMeaning meaning, bool left_operational) const;
  void tell_state(NmtState state, StateMeaning meaning);
  void on_tpdo(const Tpdo& tpdo, const Received& received);
  void on_emcy(const Received& received);
  void on_foreign_nmt(const Received& received);
  void on_silence();
  void on_doubled();
  void on_silence_after_stop();
  void on_bus_state(const BusState& state);

  // What is asked for.
  boost::asio::awaitable<Result<void>> start_by_boot(TimePoint deadline);
  boost::asio::awaitable<Result<void>> send_nmt(NmtCommand command, TimePoint deadline);
  /// Sends an NMT command of the present life: it is withdrawn when that ends, for it could start a node that was not
  /// configured since its boot-up.
  boost::asio::awaitable<Result<void>> transmit_nmt(NmtCommand command, TimePoint deadline);
  void withdraw_nmt(NmtGroup which);
  [[nodiscard]] Error withdrawn_error() const;
  /// No command that has not begun may reach a node that is not operational any more.
  void withdraw_commands();
  void on_nmt_left(NmtCommand command);
  void settle_start_requests(const Result<void>& result);
  /// Who waits for a start wants the boot that begins or ends now to end in one.
  void take_start_requests();
  [[nodiscard]] Error silent_error() const;
  [[nodiscard]] bool start_needs_boot() const;
  [[nodiscard]] bool takes_commands() const;
  [[nodiscard]] std::optional<Error> why_unreadable(ObjectAddress object) const;
  [[nodiscard]] Error not_in_service(ObjectAddress object) const;
  [[nodiscard]] Error offline_error(ObjectAddress object, std::string detail) const;

  boost::asio::any_io_executor executor_;
  Bus& bus_;
  NodeSettings settings_;
  NodeEvents& events_;
  NodeStatus status_;

  Event changed_;  ///< Something was heard or asked for, or the life is over.
  Event ended_;    ///< The coroutine or an operation ended.
  SdoClient sdo_;
  AbortCounts aborts_;
  Outputs outputs_;
  HeartbeatConsumer watch_;  ///< Of whatever tells that it lives.
  NodeGuarding guarding_;
  DoubledWatch doubled_;
  std::vector<Tpdo> tpdos_;
  std::vector<std::uint16_t> verified_tpdos_;

  Life* life_ = nullptr;  ///< The present one.
  Stage stage_ = Stage::searching;
  Heard heard_;
  NmtExpectation expectation_;
  std::string half_done_;
  bool self_start_due_ = false;  ///< It has rebooted, and was not made pre-operational since (self_starting).
  Restart restart_;
  RetryPause retry_;
  TimePoint retry_at_{};  ///< Before that it is not booted again, unless something was heard of it that is new.
  SdoPatience patience_;
  bool lost_waiting_ = false;    ///< It was lost while it waited for that.
  bool slow_heartbeat_ = false;  ///< So it was read since its boot-up.
  bool restarting_ = false;      ///< The next life is for that.
  TimePoint serial_read_at_{};   ///< When it is read next, where there are hints of a second node.
  std::string hold_reason_;      ///< Why it was not started again when it was tried.
  bool running_ = false;
  bool closing_ = false;
  bool stopping_ = false;
  std::size_t operations_ = 0;
  std::vector<NmtSending*> nmt_sendings_;
  std::vector<StartRequest*> start_requests_;

  std::vector<Subscription> subscriptions_;
};

template <class Change>
void RemoteNode::change_status(Change change) {
  NodeStatus before = status_;
  change(status_);
  before.last_heartbeat = status_.last_heartbeat;
  if (status_ != before) {
    events_.on_status(status_);
  }
}

}  // namespace canopen
