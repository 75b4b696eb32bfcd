#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "bridges/alarms/alarm.h"
#include "bridges/mqtt/bridge.h"
#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/subscription.h"
#include "canopen/bus/virtual_link.h"
#include "config/model.h"
#include "simulator/drive.h"
#include "simulator/network.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/unit/mqtt/fake_broker.h"

namespace mqtt::test {

/// A simulated drive `pump1`, a gateway and a broker that holds what was retained, each of which can go and come back.
/// Time is moved by hand.
class RestartSite {
 public:
  /// `remembers`: the gateway has its alarms' memory; else it starts without any each time.
  RestartSite(const std::string& profile, bool remembers);
  ~RestartSite();
  RestartSite(const RestartSite&) = delete;
  RestartSite& operator=(const RestartSite&) = delete;

  /// Killed: neither the broker nor the drive hears of its end.
  void kill_gateway();
  void start_gateway();
  /// It loses nothing of what is retained.
  void stop_broker();
  void start_broker();
  void stop_drive() { drive_->power_off(); }
  void start_drive() { drive_->power_on(); }

  /// What the drive's fault is from now on; a drive that has no power takes it when it has booted.
  void set_fault(std::optional<std::uint16_t> code);
  void run(canopen::Duration time);

  /// Nothing where no such topic is there.
  [[nodiscard]] std::string retained(const std::string& topic) const;
  [[nodiscard]] process::Drive& drive() { return gateway_->plant.drive(0); }

 private:
  struct Gateway {
    Gateway(support::HandDrivenLoop& loop, canopen::VirtualBus& wire, const config::Model& model,
            std::map<std::string, std::string>& retained);
    canopen::Bus bus;
    process::Plant plant;
    canopen::Subscription bus_state;
    FakeBroker* broker;  ///< Owned by the bridge.
    Bridge bridge;
  };

  void connect();
  void give_fault();

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  config::Model model_;
  bool remembers_;
  std::optional<std::array<alarms::Alarm, alarms::kAlarmKinds.size()>> memory_;
  simulator::Network network_{loop_.executor(), wire_.connect()};
  std::unique_ptr<simulator::Drive> drive_;
  std::optional<std::uint16_t> fault_;
  bool to_give_ = false;
  std::map<std::string, std::string> retained_;
  bool broker_up_ = true;
  ConnectionId connections_ = 0;
  std::unique_ptr<Gateway> gateway_;
};

}  // namespace mqtt::test
