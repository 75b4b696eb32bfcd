#include "tests/unit/modbus/simulated_plant.h"

#include <gtest/gtest.h>

#include <array>
#include <boost/asio/co_spawn.hpp>
#include <exception>
#include <stdexcept>

#include "bridges/process/answer.h"
#include "config/load.h"
#include "tests/support/spawn.h"
#include "tests/unit/modbus/bytes.h"

namespace modbus_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kPdu = 7;  ///< Where it begins in a frame.
constexpr std::uint8_t kGatewayNode = 127;

std::string digits_of(std::uint16_t word) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const unsigned shift : {12U, 8U, 4U, 0U}) {
    text += kDigits[(unsigned{word} >> shift) & 0xFU];
  }
  return text;
}

config::Model model_of(const std::string& drives) {
  const std::string site =
      "[[bus]]\nname = \"can0\"\ninterface = \"virtual\"\n[modbus]\nlisten = [\"127.0.0.1:1502\"]\n" + drives;
  config::Loaded loaded = config::load_text(
      site, {.file = "site.toml", .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = "host"});
  if (!loaded.model) {
    throw std::invalid_argument("the site does not load: " + config::to_string(loaded.findings.front()));
  }
  loaded.model->gateway.state_dir.clear();
  loaded.model->modbus->listen = {{"127.0.0.1", 0}};
  return *std::move(loaded.model);
}

}  // namespace

void CommandAnswers::on_command_done(const process::Drive& drive, const process::CommandRecord& /*record*/,
                                     const process::Outcome& outcome) {
  last[drive.model().name] = outcome;
}

SimulatedPlant::Gateway::Gateway(support::HandDrivenLoop& loop, canopen::VirtualBus& wire, const config::Model& model,
                                 CommandAnswers& answers)
    : bus(loop.executor(), wire.connect(), {.bitrate = 250000, .node_id = kGatewayNode, .heartbeat = {}, .sync = {}}),
      plant(loop.executor(), model, {{&bus, [this] { return bus.statistics(); }}}),
      bus_state(bus.subscribe_state([this](const canopen::BusState& state) { plant.set_bus_state(0, state); })),
      server(loop.executor(), plant, *model.modbus) {
  plant.add(server);
  plant.add(answers);
  server.start();
  bus.start();
  plant.start();
}

SimulatedPlant::SimulatedPlant(const std::string& drives) : model_(model_of(drives)) {
  tap_->open(*this);
  network_.open();
  for (const config::Drive& drive : model_.drives) {
    auto& simulated = drives_[drive.node.node];
    simulated = simulator::make_drive(drive.profile, drive.node.node, network_);
    simulated->power_on();
  }
  start_gateway();
}

SimulatedPlant::~SimulatedPlant() {
  end_gateway();
  tap_->close();
}

void SimulatedPlant::start_gateway() {
  gateway_ = std::make_unique<Gateway>(loop_, wire_, model_, answers_);
  const bool online = loop_.advance_until([this] { return gateway_->plant.online() == gateway_->plant.size(); }, 10s);
  for (std::size_t i = 0; !online && i < gateway_->plant.size(); ++i) {
    ADD_FAILURE() << model_.drives[i].name << ": " << gateway_->plant.drive(i).status().boot_text;
  }
  run(3s);
  client_ = std::make_unique<TcpClient>(gateway_->server.port(0));
}

void SimulatedPlant::end_gateway() {
  client_.reset();
  if (!gateway_) {
    return;
  }
  const auto ended = support::spawn(loop_.executor(), [](Gateway& gateway) -> boost::asio::awaitable<void> {
    co_await gateway.server.stop();
    co_await gateway.plant.stop();
    co_await gateway.bus.stop();
  }(*gateway_));
  EXPECT_TRUE(loop_.advance_until([&ended] { return *ended; }, 5s));
  gateway_.reset();
}

std::string SimulatedPlant::ask(std::uint8_t unit, std::string_view pdu) {
  const Bytes request = frame(unit, pdu);
  EXPECT_EQ(client_->send(request), request.size());
  const auto answered = [this] {
    client_->receive();
    return client_->has_frame() || client_->closed();
  };
  if (!loop_.advance_until(answered, 3s) || !client_->has_frame()) {
    return "";
  }
  const Bytes answer = client_->take_frame();
  std::string text;
  for (std::size_t i = kPdu; i < answer.size(); ++i) {
    text += digits_of(answer[i]).substr(2);
  }
  return text;
}

std::string SimulatedPlant::command(std::uint8_t unit, std::uint16_t control, std::uint16_t frequency,
                                    std::uint16_t torque, std::uint16_t velocity) {
  return ask(unit,
             "10 0064 0004 08 " + digits_of(control) + digits_of(frequency) + digits_of(torque) + digits_of(velocity));
}

std::uint16_t SimulatedPlant::read(std::uint8_t unit, std::uint16_t address) {
  const std::string answer = ask(unit, "03 " + digits_of(address) + " 0001");
  if (answer.size() != 8) {
    ADD_FAILURE() << "register " << address << ": " << answer;
    return 0;
  }
  return static_cast<std::uint16_t>(std::stoul(answer.substr(4), nullptr, 16));
}

std::string SimulatedPlant::failure(const std::string& drive) const {
  const auto found = answers_.last.find(drive);
  return found == answers_.last.end() || !found->second.failure ? "" : canopen::to_string(*found->second.failure);
}

bool SimulatedPlant::turns(std::uint8_t node) {
  return drive(node).motor().state() != simulator::MotorState::stopped;
}

std::vector<std::uint16_t> SimulatedPlant::control_words(std::uint8_t node) const {
  std::vector<std::uint16_t> words;
  for (const canopen::Frame& frame : heard_) {
    if (frame.id == 0x200U + node && frame.size >= 2) {
      words.push_back(static_cast<std::uint16_t>(frame.data[0] | (frame.data[1] << 8U)));
    }
  }
  return words;
}

void SimulatedPlant::on_frames(std::span<const canopen::Received> frames) {
  for (const canopen::Received& received : frames) {
    heard_.push_back(received.frame);
  }
}

}  // namespace modbus_test
