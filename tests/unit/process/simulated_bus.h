#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/bus_watch.h"
#include "canopen/bus/subscription.h"
#include "canopen/bus/virtual_link.h"
#include "config/model.h"
#include "simulator/drive.h"
#include "simulator/network.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

namespace process {

/// Somebody else on the bus: what he is told to he sends, and he remembers all that he hears.
class Neighbour final : private canopen::LinkEvents {
 public:
  explicit Neighbour(canopen::VirtualBus& bus) : link_(bus.connect()) { link_->open(*this); }
  ~Neighbour() { link_->close(); }
  Neighbour(const Neighbour&) = delete;
  Neighbour& operator=(const Neighbour&) = delete;

  void send(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    static_cast<void>(link_->send(canopen::make_frame(id, std::span(bytes.begin(), bytes.size()))));
  }
  [[nodiscard]] std::size_t heard(std::uint32_t id) const;
  /// Downloads to the node that were begun.
  [[nodiscard]] std::size_t downloads(std::uint8_t node) const;
  void forget() { frames_.clear(); }

 private:
  void on_frames(std::span<const canopen::Received> frames) override;
  void on_echo(const canopen::Received&) override {}
  void on_bus_state(const canopen::BusState&) override {}
  void on_frames_lost(std::uint32_t) override {}

  std::unique_ptr<canopen::Link> link_;
  std::vector<canopen::Frame> frames_;
};

/// A gateway's plant and simulated drives on an in-process bus, by the shipped profiles. Time is moved by hand. Each
/// drive has a link of its own, so two of them may carry one node id.
class SimulatedBus : public testing::Test {
 protected:
  static constexpr std::uint8_t kGateway = 127;

  ~SimulatedBus() override;

  /// `[[drive]]` tables, and lines of [[bus]].
  void load(const std::string& drives, const std::string& bus = "");
  /// Without power.
  simulator::Drive& add(std::string_view kind, std::uint8_t node, const simulator::DriveOptions& options = {});
  /// The gateway begins.
  void start();
  void run(canopen::Duration time) { loop_.advance(time); }
  [[nodiscard]] bool wait_online(canopen::Duration limit = std::chrono::seconds(15)) {
    return loop_.advance_until([&] { return plant_->online() == plant_->size(); }, limit);
  }
  [[nodiscard]] bool wait_for(canopen::Doubled verdict, canopen::Duration limit) {
    return loop_.advance_until([&] { return status().doubled == verdict; }, limit);
  }

  [[nodiscard]] Drive& drive() { return plant_->drive(0); }
  [[nodiscard]] const canopen::NodeStatus& status() { return drive().status(); }
  [[nodiscard]] const alarms::Alarm& bus_alarm() const { return plant_->bus_alarm(0); }
  /// By name and raw value.
  Outcome write(const std::vector<std::pair<std::string, canopen::Raw>>& fields, std::size_t drive = 0);
  Outcome stop_motor();
  Outcome nmt(canopen::NmtCommand command);

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  Neighbour neighbour_{wire_};
  std::vector<std::unique_ptr<simulator::Network>> networks_;
  std::vector<std::unique_ptr<simulator::Drive>> drives_;
  config::Model model_;
  std::vector<canopen::Received> sent_;  ///< By the gateway.
  std::unique_ptr<canopen::Bus> bus_;
  std::unique_ptr<Plant> plant_;
  std::unique_ptr<canopen::BusWatch> watch_;
  canopen::Subscription bus_state_;
  std::vector<std::string> bus_remarks_;

 private:
  [[nodiscard]] static Origin origin() { return {.writer = {.way = Writer::Way::modbus, .address = "192.0.2.7"}}; }
  Outcome finish(const support::Spawned<Outcome>& under_way);
};

}  // namespace process
