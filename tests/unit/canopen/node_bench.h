#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "canopen/bus.h"
#include "canopen/remote_node.h"
#include "canopen/virtual_link.h"
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
  void on_frames_lost() override { ++losses; }
  void on_remark(const std::string& text) override { remarks.push_back(text); }

  std::vector<NodeStatus> statuses;
  int boot_ups = 0;
  std::vector<Arrival> arrivals;
  std::vector<std::pair<std::uint16_t, std::vector<Raw>>> tpdos;
  std::vector<std::pair<std::uint16_t, std::size_t>> wrong_lengths;
  std::vector<Emcy> emergencies;
  int losses = 0;
  std::vector<std::string> remarks;
};

constexpr std::uint8_t kTestNode = 5;
constexpr ObjectAddress kHeartbeatTime{0x1017, 0};
constexpr ObjectAddress kControlWord{0x6040, 0};
constexpr ObjectAddress kTarget{0x6042, 0};

/// One TPDO and one RPDO of a CiA 402 drive, all written.
inline NodeSettings bench_settings() {
  NodeSettings settings;
  settings.node = kTestNode;
  PdoSettings tpdo;
  tpdo.cob_id = 0x185;
  tpdo.transmission_type = std::uint8_t{255};
  tpdo.event_timer = std::uint16_t{100};
  tpdo.period = std::chrono::milliseconds(100);
  tpdo.mapping = {{{0x6041, 0}, DataType::u16, 16, FieldUse::commanded},
                  {{0x6044, 0}, DataType::i16, 16, FieldUse::commanded}};
  PdoSettings rpdo;
  rpdo.cob_id = 0x205;
  rpdo.transmission_type = std::uint8_t{255};
  rpdo.mapping = {{kControlWord, DataType::u16, 16, FieldUse::commanded},
                  {kTarget, DataType::i16, 16, FieldUse::commanded}};
  settings.tpdos = {tpdo};
  settings.rpdos = {rpdo};
  return settings;
}

/// A remote node on an in-process bus with a scripted slave whose dictionary is as the settings want it.
class NodeBench : public testing::Test {
 protected:
  NodeBench() { bus_.start(); }
  ~NodeBench() override {
    if (node_) {
      const std::size_t heard = slave_.heard().size();
      const auto stopped = support::spawn(loop_.executor(), node_->stop());
      loop_.settle();
      EXPECT_TRUE(*stopped);
      EXPECT_EQ(slave_.heard().size(), heard) << "an end sends nothing";
      node_.reset();
    }
    const auto stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
  }

  static BusSettings quiet_bus() {
    BusSettings settings;
    settings.heartbeat = Duration::zero();
    return settings;
  }

  /// The slave's dictionary as `settings` want it.
  void install(const NodeSettings& settings) {
    slave_.set({0x1000, 0}, DataType::u32, 0x00010192);
    slave_.set({0x1018, 1}, DataType::u32, 0x90);
    slave_.set(kHeartbeatTime, DataType::u16, 500);
    for (const PdoSettings& pdo : settings.tpdos) {
      install(pdo, 0x1800);
    }
    for (const PdoSettings& pdo : settings.rpdos) {
      install(pdo, 0x1400);
    }
    slave_.set(kControlWord, DataType::u16, 0);
    slave_.set(kTarget, DataType::i16, 0);
  }
  void install(const PdoSettings& pdo, std::uint16_t base) {
    const auto communication = static_cast<std::uint16_t>(base + pdo.number - 1);
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    slave_.set({communication, 1}, DataType::u32, pdo.cob_id | 0x4000'0000U);
    slave_.set({communication, 2}, DataType::u8, pdo.transmission_type.value_or(254));
    slave_.set({communication, 3}, DataType::u16, pdo.inhibit_time.value_or(0));
    slave_.set({communication, 5}, DataType::u16, pdo.event_timer.value_or(0));
    slave_.set({mapping, 0}, DataType::u8, pdo.mapping.size());
    std::uint8_t sub = 0;
    for (const MappedObject& mapped : pdo.mapping) {
      slave_.set({mapping, ++sub}, DataType::u32,
                 (Raw{mapped.object.index} << 16U) | (Raw{mapped.object.sub} << 8U) | mapped.bits);
    }
  }

  void start(const NodeSettings& settings) {
    node_ = std::make_unique<RemoteNode>(loop_.executor(), bus_, settings, events_);
    node_->start();
    loop_.settle();
  }
  /// The slave boots, and the node comes online.
  void bring_online(const NodeSettings& settings) {
    install(settings);
    start(settings);
    slave_.boot_up();
    ASSERT_TRUE(wait_online()) << status().boot_text;
    // The first heartbeat that says so, and the end of the time in which another state is no wonder.
    loop_.advance(std::chrono::milliseconds(2100));
    slave_.forget_heard();
  }
  [[nodiscard]] bool wait_online(Duration limit = std::chrono::seconds(2)) {
    return loop_.advance_until([this] { return status().online; }, limit);
  }
  [[nodiscard]] const NodeStatus& status() const { return node_->status(); }
  [[nodiscard]] std::vector<Frame> nmt_heard() const { return slave_.heard_on(0); }
  void send_tpdo(std::uint16_t status_word, std::uint16_t speed) {
    slave_.send(0x185, {static_cast<std::uint8_t>(status_word & 0xFFU), static_cast<std::uint8_t>(status_word >> 8U),
                        static_cast<std::uint8_t>(speed & 0xFFU), static_cast<std::uint8_t>(speed >> 8U)});
    loop_.settle();
  }

  support::HandDrivenLoop loop_;
  VirtualBus wire_{loop_.executor()};
  Bus bus_{loop_.executor(), wire_.connect(), quiet_bus()};
  support::ScriptedSlave slave_{loop_.executor(), wire_, kTestNode};
  RecordedEvents events_;
  std::unique_ptr<RemoteNode> node_;
};

inline Frame nmt(std::uint8_t command) {
  return make_frame(0, std::vector<std::uint8_t>{command, kTestNode});
}

}  // namespace canopen
