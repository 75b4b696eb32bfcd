#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "canopen/node/remote_node.h"
#include "tests/support/gated_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/scripted_slave.h"
#include "tests/support/spawn.h"

namespace canopen {

/// Remembers what a remote node told.
class RecordedEvents final : public NodeEvents {
 public:
  void on_status(const NodeStatus& status) override { statuses.push_back(status); }
  void on_boot_up() override { ++boot_ups; }
  void on_arrival(Arrival arrival) override { arrivals.push_back(arrival); }
  void on_tpdo(std::uint16_t number, std::span<const Raw> values, TimePoint, WallTime) override {
    tpdos.emplace_back(number, std::vector<Raw>(values.begin(), values.end()));
  }
  void on_tpdo_length(std::uint16_t number, std::size_t, std::size_t received) override {
    wrong_lengths.emplace_back(number, received);
  }
  void on_emcy(const Emcy& emcy, TimePoint, WallTime) override { emergencies.push_back(emcy); }
  void on_emcy_checked(const EmcyVerdict& verdict) override { emcy_verdicts.push_back(verdict); }
  void on_frames_lost() override { ++losses; }
  std::optional<std::vector<ObjectValue>> repetition(std::uint16_t rpdo) override {
    return rpdo == 1 && !repeated.empty() ? std::optional(repeated) : std::nullopt;
  }
  void on_remark(const std::string& text) override { remarks.push_back(text); }

  std::vector<NodeStatus> statuses;
  int boot_ups = 0;
  std::vector<Arrival> arrivals;
  std::vector<std::pair<std::uint16_t, std::vector<Raw>>> tpdos;
  std::vector<std::pair<std::uint16_t, std::size_t>> wrong_lengths;
  std::vector<Emcy> emergencies;
  std::vector<EmcyVerdict> emcy_verdicts;
  int losses = 0;
  std::vector<std::string> remarks;
  std::vector<ObjectValue> repeated;  ///< What RPDO1 is to be repeated with; empty: it is not.
};

constexpr std::uint8_t kTestNode = 5;
constexpr ObjectAddress kHeartbeatTime{0x1017, 0};
constexpr ObjectAddress kControlWord{0x6040, 0};
constexpr ObjectAddress kTarget{0x6042, 0};
/// Bit 2 of the status word: operation enabled (CiA 402).
const MotorSign kRunning{{0x6041, 0}, DataType::u16, 4, {4}};

/// One TPDO and one RPDO of a CiA 402 drive, all written.
NodeSettings bench_settings();
Frame nmt(std::uint8_t command);

/// A remote node on an in-process bus with a scripted slave whose dictionary is as the settings want it.
class NodeBench : public testing::Test {
 protected:
  NodeBench() { bus_.start(); }
  ~NodeBench() override;

  static BusSettings quiet_bus();

  /// The slave's dictionary as `settings` want it.
  void install(const NodeSettings& settings);
  void install(const PdoSettings& pdo, std::uint16_t base);
  /// The same of a slave that has been running for long, with its heartbeat in step with our start.
  void running(const NodeSettings& settings);
  void start(const NodeSettings& settings);
  /// The slave boots, and has time to be configured.
  void boot(const NodeSettings& settings);
  /// The slave boots, and the node comes online.
  void bring_online(const NodeSettings& settings);
  [[nodiscard]] bool wait_online(Duration limit = std::chrono::seconds(2));
  void send_tpdo(std::uint16_t status_word, std::uint16_t speed);
  /// A test that takes a heartbeat away has none before either.
  void without_heartbeat() { slave_.heartbeat_off(true); }
  /// The node loses its heartbeat.
  void lose();

  [[nodiscard]] const NodeStatus& status() const { return node_->status(); }
  [[nodiscard]] std::vector<Frame> nmt_heard() const { return slave_.heard_on(0); }
  void expect_untouched();
  /// Not online and not started, for this reason.
  void expect_letter(BootResult letter, const std::string& text_part);
  /// Operational with a difference: neither a write nor an NMT command.
  void expect_left_alone(const std::string& text_part);

  support::HandDrivenLoop loop_;
  VirtualBus wire_{loop_.executor()};
  bool closed_ = false;  ///< Nothing of ours can leave.
  Bus bus_{loop_.executor(), std::make_unique<support::GatedLink>(wire_.connect(), closed_), quiet_bus()};
  support::ScriptedSlave slave_{loop_.executor(), wire_, kTestNode};
  RecordedEvents events_;
  std::unique_ptr<RemoteNode> node_;
};

/// The same with commands.
class NodeCommandBench : public NodeBench {
 protected:
  static constexpr Duration kDeadline = std::chrono::milliseconds(800);
  using Sent = support::Spawned<Result<void>>;

  Sent command(NmtCommand command, Duration within = kDeadline);
  Result<void> command_now(NmtCommand what);
  Sent write(Raw raw, Duration within = kDeadline);
  /// Once it has left, this is what is repeated where the drive supervises it.
  Sent rpdo(std::vector<ObjectValue> fields, Duration within = kDeadline);
  Result<void> rpdo_now(std::vector<ObjectValue> fields);
  static ObjectValue control(Raw raw) { return {kControlWord, DataType::u16, raw}; }
  static ObjectValue target(Raw raw) { return {kTarget, DataType::i16, raw}; }
  void expect_write_refused();

 private:
  boost::asio::awaitable<Result<void>> send_and_note(std::vector<ObjectValue> fields, TimePoint deadline);
};

}  // namespace canopen
