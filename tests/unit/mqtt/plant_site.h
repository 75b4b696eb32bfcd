#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "bridges/mqtt/bridge.h"
#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "config/model.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/puppet.h"
#include "tests/unit/mqtt/fake_broker.h"
#include "tests/unit/mqtt/site.h"

namespace mqtt::test {

[[nodiscard]] inline bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

/// A plant with one puppet drive and the MQTT bridge on a broker that the test plays; time moved by hand.
class PlantSite {
 public:
  /// `emcy`: the drive's emergency alarm as memory holds it from before the start.
  explicit PlantSite(config::Model model = bridge_model(), const std::optional<alarms::Alarm>& emcy = {});
  ~PlantSite();
  PlantSite(const PlantSite&) = delete;
  PlantSite& operator=(const PlantSite&) = delete;

  /// test::model() with all values readable by the puppet's simple SDO.
  [[nodiscard]] static config::Model bridge_model();

  /// The drive boots, is configured and started, and sends its values.
  void bring_up_drive();
  /// The broker connects, grants the subscription.
  void connect(ConnectionId connection = 1);
  /// The drive's TPDO: status word, frequency in 0.01 Hz, state, fault code.
  void send_values(std::uint16_t status, std::uint16_t frequency, std::uint8_t state, std::uint16_t fault_code = 0);
  /// Time passes with heartbeat and TPDO every 50 ms.
  void run(canopen::Duration time);
  /// Time passes with the heartbeat alone.
  void run_silent(canopen::Duration time);
  /// A message from the broker, and what follows of it within `time`.
  void receive(Incoming message, canopen::Duration time = std::chrono::milliseconds(0));
  void command(const std::string& topic, const std::string& payload);
  /// Answers on this topic since the last forget().
  [[nodiscard]] std::string last_answer(const std::string& topic = "canopen/line3/result") const;
  [[nodiscard]] std::string retained(const std::string& topic) const;
  void stop_bridge();
  /// The plant has another configuration, with the same bus.
  void change(config::Model model);

  support::HandDrivenLoop& loop() noexcept { return loop_; }
  support::Puppet& puppet() noexcept { return puppet_; }
  FakeBroker& broker() noexcept { return *broker_; }
  Bridge& bridge() noexcept { return bridge_; }
  process::Plant& plant() noexcept { return plant_; }
  [[nodiscard]] const std::vector<std::string>& notices() const noexcept { return notices_; }

 private:
  support::HandDrivenLoop loop_;
  config::Model model_;
  canopen::VirtualBus can_;
  support::Puppet puppet_;
  canopen::Bus bus_;
  process::Plant plant_;
  FakeBroker* broker_;  ///< Owned by the bridge.
  std::vector<std::string> notices_;
  Bridge bridge_;
  std::vector<std::uint8_t> values_;
  bool bridge_stopped_ = false;
};

}  // namespace mqtt::test
