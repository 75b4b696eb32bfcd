#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canopen/bus/subscription.h"
#include "canopen/bus/transmission.h"
#include "canopen/event.h"
#include "canopen/node/boot.h"
#include "canopen/node/heartbeat_consumer.h"
#include "canopen/node/outputs.h"
#include "canopen/node/pdo.h"
#include "canopen/node/remote_node.h"
#include "canopen/node/takeover.h"
#include "canopen/sdo/client.h"

namespace canopen {

struct BusState;
struct Received;

/// The inside of a RemoteNode. One coroutine walks the node through its life; the frame handlers only record what they
/// hear, turn the phase where the old one cannot go on, and wake the coroutine.
///
/// Parts: node_supervisor.cpp the life, node_arrival.cpp how it comes online, node_reception.cpp what is heard,
/// node_commands.cpp what is asked for.
class RemoteNode::Supervisor final : private NmtLine {
 public:
  Supervisor(boost::asio::any_io_executor executor, Bus& bus, NodeSettings settings, NodeEvents& events);
  virtual ~Supervisor() = default;
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  void start();
  void close();
  boost::asio::awaitable<void> stop();

  [[nodiscard]] const NodeSettings& settings() const noexcept { return settings_; }
  [[nodiscard]] const NodeStatus& status() const noexcept { return status_; }
  [[nodiscard]] TimePoint heard_until() const;
  [[nodiscard]] bool tpdo_verified(std::uint16_t number) const noexcept;
  [[nodiscard]] Outputs& rpdos() noexcept { return rpdos_; }

  boost::asio::awaitable<Result<Raw>> read(ObjectAddress object, DataType type, TimePoint due);
  boost::asio::awaitable<Result<void>> write(ObjectAddress object, DataType type, Raw raw, TimePoint deadline,
                                             StillStands still_stands = {});
  boost::asio::awaitable<Result<void>> command(NmtCommand command, TimePoint deadline);
  boost::asio::awaitable<Result<void>> send_rpdo(std::uint16_t number, std::vector<ObjectValue> fields,
                                                 TimePoint deadline);

 private:
  enum class Phase : std::uint8_t {
    idle,        ///< State unknown, or waiting for another try.
    inspecting,  ///< Found operational; being compared with the settings.
    booting,     ///< Being configured.
    starting,    ///< NMT start is on its way or has left; not seen operational yet.
    online
  };
  /// Why the node is not to be started.
  enum class Hold : std::uint8_t { none, by_command, by_itself };
  class Operation;
  /// Pause before a node that could not be booted or taken over is tried again.
  static constexpr Duration kRetryInterval = std::chrono::seconds(5);
  struct Tpdo {
    std::uint16_t number = 0;
    PdoPlan plan;
  };

  // The life.
  boost::asio::awaitable<void> run();
  boost::asio::awaitable<void> live_once();
  boost::asio::awaitable<void> wait_for_bus();
  boost::asio::awaitable<void> stay_silent();
  boost::asio::awaitable<void> take_over();
  boost::asio::awaitable<void> bring_up(FoundState found);
  boost::asio::awaitable<void> serve();
  boost::asio::awaitable<void> fail(BootReport report);
  /// Neither configures nor starts a node that left operational by itself; only looks whether that is over.
  boost::asio::awaitable<void> hold_back(FoundState found);
  /// Waits until `until`, until `over` says so, or for an interruption.
  boost::asio::awaitable<void> pause(TimePoint until, bool (Supervisor::*over)() const);
  [[nodiscard]] bool heard_sign() const { return signs_.boot_up || signs_.state.has_value() || start_requested_; }
  [[nodiscard]] bool boot_wanted() const { return signs_.boot_up || start_requested_; }
  [[nodiscard]] bool not_operational() const { return boot_wanted() || signs_.state != NmtState::operational; }
  [[nodiscard]] bool hold_over() const { return boot_wanted() || signs_.state == NmtState::operational; }
  void forget_stale_signs();
  [[nodiscard]] bool heartbeat_is_fresh() const;

  // NmtLine
  boost::asio::awaitable<bool> heartbeat_after(TimePoint since) override;
  [[nodiscard]] bool may_start() const override { return hold_ == Hold::none; }
  void settings_done(const BootReport& report) override;
  boost::asio::awaitable<std::optional<BootFailure>> start_node() override;

  /// Whether a heartbeat comes where the takeover must not do without one.
  boost::asio::awaitable<bool> heartbeat_as_needed();
  void arrive(Arrival arrival);
  static void note_left_by_itself(NodeStatus& status);
  /// Ends the present phase: what is pending fails as offline, RPDOs are void.
  void leave_service();
  /// Sends an NMT command. `of_this_life`: it is withdrawn when the present phase ends, for it could start a node that
  /// was not set up since its boot-up.
  boost::asio::awaitable<Result<void>> transmit_nmt(NmtCommand command, TimePoint deadline, bool of_this_life);
  void withdraw_nmt(bool all);
  /// No command that has not begun may reach a node that is not operational any more.
  void withdraw_commands();
  /// Applies `change` to the status and tells it where a field but the heartbeat's time differs.
  template <class Change>
  void change_status(Change change);

  // What is heard.
  void subscribe();
  void on_error_control(const Received& received);
  void on_boot_up(TimePoint at);
  void on_state(NmtState state, TimePoint at);
  void on_guarding_answer(NmtState state, TimePoint at);
  /// A state of a node that is not in service.
  void take_state(NmtState state, TimePoint at);
  void on_state_online(NmtState state, TimePoint at);
  void on_tpdo(const Tpdo& tpdo, const Received& received);
  void on_emcy(const Received& received);
  void on_silence();
  void on_bus_state(const BusState& state);

  // What is asked for.
  boost::asio::awaitable<Result<void>> start_by_boot(TimePoint deadline);
  boost::asio::awaitable<Result<void>> send_nmt(NmtCommand command, TimePoint deadline);
  void on_nmt_left(NmtCommand command);
  [[nodiscard]] bool start_needs_boot() const;
  [[nodiscard]] bool takes_commands() const;
  [[nodiscard]] Error offline_error(ObjectAddress object, std::string detail) const;

  boost::asio::any_io_executor executor_;
  Bus& bus_;
  NodeSettings settings_;
  NodeEvents& events_;
  NodeStatus status_;

  Event changed_;  ///< Something was heard or asked for, or the phase turned.
  Event ended_;    ///< The coroutine or an operation ended.
  SdoClient sdo_;
  Outputs rpdos_;
  HeartbeatConsumer watch_;
  std::vector<Tpdo> tpdos_;
  std::vector<std::uint16_t> verified_tpdos_;

  Phase phase_ = Phase::idle;
  Hold hold_ = Hold::none;
  NodeSigns signs_;
  TimePoint nmt_grace_end_{};  ///< Until then any state is no wonder: an NMT command of ours has only just left.
  std::uint32_t starts_ = 0;   ///< NMT starts of boots that have left.
  bool start_requested_ = false;
  std::size_t starts_awaited_ = 0;  ///< NMT start commands that wait for the boot they asked for.
  bool searching_ = false;          ///< The state is being learnt.
  bool gave_up_ = false;            ///< A boot or takeover ended without a verdict.
  bool running_ = false;
  bool closing_ = false;
  bool stopping_ = false;
  std::size_t operations_ = 0;
  class NmtSending;
  std::vector<NmtSending*> nmt_sendings_;

  std::vector<Subscription> subscriptions_;
};

template <class Change>
void RemoteNode::Supervisor::change_status(Change change) {
  NodeStatus before = status_;
  change(status_);
  before.last_heartbeat = status_.last_heartbeat;
  if (status_ != before) {
    events_.on_status(status_);
  }
}

/// An NMT command under way, where withdraw_nmt() finds it.
class RemoteNode::Supervisor::NmtSending {
 public:
  NmtSending(Supervisor& owner, NmtCommand command, TimePoint deadline, bool of_this_life);
  ~NmtSending() { std::erase(owner_.nmt_sendings_, this); }
  NmtSending(const NmtSending&) = delete;
  NmtSending& operator=(const NmtSending&) = delete;

  boost::asio::awaitable<Result<void>> result() { return transmission_.result(); }
  void withdraw();
  [[nodiscard]] bool withdrawn() const noexcept { return withdrawn_; }
  [[nodiscard]] bool of_this_life() const noexcept { return of_this_life_; }

 private:
  Supervisor& owner_;
  Transmission transmission_;
  bool of_this_life_;
  bool withdrawn_ = false;
};

/// Counts what a RemoteNode does for a caller, so that stop() can wait for its end.
class RemoteNode::Supervisor::Operation {
 public:
  explicit Operation(Supervisor& owner) : owner_(owner) { ++owner_.operations_; }
  ~Operation() {
    --owner_.operations_;
    owner_.ended_.notify();
  }
  Operation(const Operation&) = delete;
  Operation& operator=(const Operation&) = delete;

 private:
  Supervisor& owner_;
};

}  // namespace canopen
