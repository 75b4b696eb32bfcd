#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/modbus/server.h"
#include "bridges/process/observer.h"
#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/subscription.h"
#include "canopen/bus/virtual_link.h"
#include "config/model.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/puppet.h"
#include "tests/unit/modbus/bytes.h"
#include "tests/unit/modbus/tcp_client.h"

namespace modbus_test {

inline constexpr std::uint8_t kUnit = 5;

/// Addresses of the drive of example_model().
namespace address {
inline constexpr std::uint16_t kStatusWord = 0;
inline constexpr std::uint16_t kFrequency = 2;
inline constexpr std::uint16_t kTemperature = 10;
inline constexpr std::uint16_t kControlCommand = 100;
inline constexpr std::uint16_t kFrequencyCommand = 101;
inline constexpr std::uint16_t kPosition = 200;
inline constexpr std::uint16_t kPower = 202;
inline constexpr std::uint16_t kSpeedFloat = 204;
inline constexpr std::uint16_t kAcceleration = 300;
inline constexpr std::uint16_t kTargetPosition = 302;
inline constexpr std::uint16_t kLimitFloat = 304;
inline constexpr std::uint16_t kJogSpeed = 306;
inline constexpr std::uint16_t kRamp = 308;
}  // namespace address

inline constexpr canopen::ObjectAddress kControlObject{0x2000, 1};
inline constexpr canopen::ObjectAddress kFrequencyObject{0x2000, 2};
inline constexpr canopen::ObjectAddress kAccelerationObject{0x3000, 1};
inline constexpr canopen::ObjectAddress kTargetObject{0x3000, 2};
inline constexpr canopen::ObjectAddress kLimitObject{0x3000, 3};
inline constexpr canopen::ObjectAddress kJogObject{0x3000, 4};
inline constexpr canopen::ObjectAddress kRampObject{0x3000, 5};
inline constexpr canopen::ObjectAddress kRelayObject{0x3000, 6};
inline constexpr canopen::ObjectAddress kValveObject{0x3000, 7};

/// One drive `pump1`, node and unit 5, with a signal of every kind, on loopback and any free port.
[[nodiscard]] config::Model example_model();
/// What SDO finds in that drive.
void fill_dictionary(support::Puppet& puppet);

/// What the log would hear of drives.
class Remarks final : public process::Observer {
 public:
  void on_values(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_freshness(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_commanded(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_status(const process::Drive&) override {}
  void on_alarm(const process::Drive&, alarms::AlarmKind) override {}
  void on_bus(std::size_t) override {}
  void on_remark(const process::Drive&, const std::string& text) override { texts.push_back(text); }

  std::vector<std::string> texts;
};

/// A plant with one puppet drive and a Modbus server, time moved by hand.
class Site {
 public:
  /// `passed`: what a service manager bound.
  explicit Site(config::Model model = example_model(), std::vector<int> passed = {});
  ~Site();
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  /// The drive boots, is configured and started by the gateway, and sends its values once.
  void bring_up();
  /// Moves time while the drive's heart beats and TPDO1 comes.
  void run(canopen::Duration time);
  /// Moves time with the drive's heartbeat alone.
  void run_without_values(canopen::Duration time);
  /// TPDO1: status word, output frequency, position.
  void send_values(std::uint16_t status, std::int16_t frequency, std::int32_t position);
  /// TPDO2: temperature, power, speed.
  void send_slow_values(std::int8_t temperature, float power, std::uint16_t speed);

  /// Runs what is due, with time standing still, until `done` says so. False when it does not come to that.
  [[nodiscard]] bool settle_until(const std::function<bool()>& done);
  void settle() { loop_.settle(); }
  /// Sends a request and returns the PDU of the answer as text: `03 02 1388`; `closed` or `silence` where there is
  /// none.
  [[nodiscard]] std::string ask(TcpClient& client, std::uint8_t unit, std::string_view pdu);
  [[nodiscard]] std::string ask(std::string_view pdu) { return ask(client(), kUnit, pdu); }
  /// The PDU of the next answer.
  [[nodiscard]] std::string answer(TcpClient& client);
  /// A client that stays connected.
  [[nodiscard]] TcpClient& client();
  void stop_server();
  /// The plant has another configuration. All its buses are one.
  void change(config::Model model);

  support::HandDrivenLoop& loop() noexcept { return loop_; }
  canopen::VirtualBus& can() noexcept { return can_; }
  support::Puppet& puppet() noexcept { return puppet_; }
  process::Plant& plant() noexcept { return plant_; }
  modbus::Server& server() noexcept { return server_; }
  [[nodiscard]] std::vector<std::string>& remarks() noexcept { return remarks_.texts; }
  /// What the server told of connections, as `info: …` and `warning: …`.
  [[nodiscard]] const std::vector<std::string>& notices() const noexcept { return notices_; }
  [[nodiscard]] std::size_t noticed(const std::string& part) const;
  [[nodiscard]] std::uint16_t port() const { return server_.port(0); }

 private:
  void step(bool values);
  [[nodiscard]] std::vector<process::Plant::BusPort> ports(const config::Model& model);

  support::HandDrivenLoop loop_;
  config::Model model_;
  canopen::VirtualBus can_;
  support::Puppet puppet_;
  canopen::Bus bus_;
  Remarks remarks_;
  process::Plant plant_;
  canopen::Subscription bus_state_;
  std::vector<std::string> notices_;
  modbus::Server server_;
  std::unique_ptr<TcpClient> client_;
  std::array<std::uint8_t, 8> values_{};
};

}  // namespace modbus_test
