#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/modbus/server.h"
#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/subscription.h"
#include "canopen/bus/virtual_link.h"
#include "config/model.h"
#include "simulator/drive.h"
#include "simulator/network.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/unit/modbus/tcp_client.h"

namespace modbus_test {

/// The answer to SimulatedPlant::command() where the drive has it.
inline constexpr std::string_view kWritten = "1000640004";

/// How the commands ended, by the drive's name.
class CommandAnswers final : public process::Observer {
 public:
  void on_values(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_freshness(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_commanded(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_command_done(const process::Drive& drive, const process::CommandRecord&,
                       const process::Outcome& outcome) override;
  void on_status(const process::Drive&) override {}
  void on_alarm(const process::Drive&, alarms::AlarmKind) override {}
  void on_bus(std::size_t) override {}

  std::map<std::string, process::Outcome> last;
};

/// Simulated drives, the shipped profiles that know nothing of them, and a gateway with its Modbus server that can go
/// and come anew. Time is moved by hand.
class SimulatedPlant final : public canopen::LinkEvents {
 public:
  /// The `[[drive]]` tables of a site. Each drive's unit is its node, its kind its profile.
  explicit SimulatedPlant(const std::string& drives);
  ~SimulatedPlant();
  SimulatedPlant(const SimulatedPlant&) = delete;
  SimulatedPlant& operator=(const SimulatedPlant&) = delete;

  /// A gateway that knows nothing of what was. Returns once all drives are online with fresh values.
  void start_gateway();
  void end_gateway();
  void run(canopen::Duration time) { loop_.advance(time); }

  /// The PDU of the answer as digits: `1000640004`; empty where none came within 3 s of moved time.
  [[nodiscard]] std::string ask(std::uint8_t unit, std::string_view pdu);
  /// Function 16 to 100..103.
  [[nodiscard]] std::string command(std::uint8_t unit, std::uint16_t control, std::uint16_t frequency,
                                    std::uint16_t torque, std::uint16_t velocity);
  [[nodiscard]] std::uint16_t read(std::uint8_t unit, std::uint16_t address);
  /// Why the last command to the drive failed; empty where it did not.
  [[nodiscard]] std::string failure(const std::string& drive) const;

  [[nodiscard]] simulator::Drive& drive(std::uint8_t node) { return *drives_.at(node); }
  [[nodiscard]] process::Drive& process_drive(std::size_t index) { return gateway_->plant.drive(index); }
  [[nodiscard]] support::HandDrivenLoop& loop() noexcept { return loop_; }
  [[nodiscard]] bool turns(std::uint8_t node);

  /// The first words of the RPDO1s that went to the node since the last forget().
  [[nodiscard]] std::vector<std::uint16_t> control_words(std::uint8_t node) const;
  void forget() { heard_.clear(); }

  void on_frames(std::span<const canopen::Received> frames) override;
  void on_echo(const canopen::Received&) override {}
  void on_bus_state(const canopen::BusState&) override {}
  void on_frames_lost(std::uint32_t) override {}

 private:
  struct Gateway {
    Gateway(support::HandDrivenLoop& loop, canopen::VirtualBus& wire, const config::Model& model,
            CommandAnswers& answers);
    canopen::Bus bus;
    process::Plant plant;
    canopen::Subscription bus_state;
    modbus::Server server;
  };

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  config::Model model_;
  CommandAnswers answers_;
  std::unique_ptr<canopen::Link> tap_ = wire_.connect();
  std::vector<canopen::Frame> heard_;
  simulator::Network network_{loop_.executor(), wire_.connect()};
  std::map<std::uint8_t, std::unique_ptr<simulator::Drive>> drives_;
  std::unique_ptr<Gateway> gateway_;
  std::unique_ptr<TcpClient> client_;
};

}  // namespace modbus_test
