#include "daemon/demo_screen.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "simulator/drive.h"

namespace gateway {
namespace {

constexpr canopen::Duration kOften = std::chrono::seconds(2);
constexpr canopen::Duration kSeldom = std::chrono::seconds(10);

std::string_view state_of(const process::Drive& drive) noexcept {
  return drive.status().online ? canopen::name_of(drive.status().nmt) : std::string_view("offline");
}

// `49.97 Hz`, or `-` for a value that the drive lacks or that is not fresh.
std::string value_of(const process::Drive& drive, std::string_view name, canopen::TimePoint now) {
  const auto id = drive.model().find(name);
  if (!id) {
    return "";
  }
  const config::Signal& signal = drive.model().signals[*id];
  const auto position = static_cast<process::SignalId>(*id);
  if (!drive.image().fresh(position, now)) {
    return fmt::format("{} -", name);
  }
  if (signal.type == canopen::DataType::boolean) {
    return fmt::format("{} {}", name, drive.image().raw(position) != 0 ? "yes" : "no");
  }
  const double number = canopen::to_number(signal.type, drive.image().raw(position)) * signal.scale;
  return fmt::format("{} {:.{}f} {}", name, number, signal.decimals, signal.unit);
}

std::string alarms_of(const process::Drive& drive) {
  std::string text;
  for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
    if (const alarms::Alarm& alarm = drive.alarm(kind); alarm.known && alarm.active) {
      text += fmt::format("   ALARM {}{}: {}", alarms::name_of(kind), alarm.first ? " (first)" : "", alarm.text);
    }
  }
  return text;
}

// One drive's commands in the words of its own control word.
struct ControlWords {
  std::string_view profile;
  std::string_view setpoint;
  int run;
  int stop;
  int reset;  ///< Of a fault.
  double example;
  bool staged;  ///< CiA 402: shutdown and switch on come before, and a fault reset is an edge.
};
constexpr std::array<ControlWords, 4> kControlWords{{{"veichi-ac300", "frequency_command", 1, 5, 7, 40.0, false},
                                                     {"veichi-ac310", "frequency_command", 1, 5, 7, 40.0, false},
                                                     {"invt-goodrive600", "frequency_command", 1, 5, 7, 40.0, false},
                                                     {"vacon-opte6", "target_velocity", 127, 6, 128, 900.0, true}}};

const ControlWords* control_words(const config::Drive& drive) noexcept {
  for (const ControlWords& words : kControlWords) {
    if (words.profile == drive.profile) {
      return &words;
    }
  }
  return nullptr;
}

// The lines carry no ids: so they may be given again and again.
void add_mqtt_lines(std::string& text, const config::Model& model, const config::Drive& drive) {
  const ControlWords* const words = control_words(drive);
  if (words == nullptr) {
    return;
  }
  const std::string at = fmt::format("-h {} -p {}", model.mqtt->brokers.front().host, model.mqtt->brokers.front().port);
  const std::string topics = model.mqtt->base + "/" + model.gateway.name + "/" + drive.name;
  const std::string to = fmt::format("  mosquitto_pub {} -t {}", at, topics);
  const std::string alarm = fmt::format("  mosquitto_sub {} -C 1 -t {}/alarm/emcy\n", at, topics);
  if (words->staged) {
    text += fmt::format("{0}/control_command/set -m 6   # shutdown\n{0}/control_command/set -m 7   # switch on\n", to);
  }
  text += fmt::format("{}/set -m '{{\"{}\":{:.1f},\"control_command\":{}}}'   # run\n", to, words->setpoint,
                      words->example, words->run);
  text += fmt::format("{}/control_command/set -m {}   # stop\n", to, words->stop);
  if (drive.commands.raw) {  // A fault from outside: the simulated drives' own object, reached by an SDO request.
    text += fmt::format(
        "{}/sdo/request -m '{{\"op\":\"write\",\"object\":\"{}\",\"type\":\"u16\",\"value\":5}}'   # it trips\n", to,
        to_string(canopen::ObjectAddress{simulator::kTroubleObject.index, simulator::kTroubleObject.sub}));
    text += alarm;
  }
  if (words->staged) {
    text += fmt::format("{}/control_command/set -m 0   # before a fault reset, which is a rising bit 7\n", to);
  }
  text += fmt::format("{}/control_command/set -m {}   # fault reset\n", to, words->reset);
  text += alarm;
}

void add_modbus_lines(std::string& text, const config::Model& model, const config::Drive& drive) {
  const config::Endpoint& endpoint = model.modbus->listen.front();
  const auto add = [&](std::string_view signal, std::string_view value) {
    const auto id = drive.find(signal);
    if (id && drive.signals[*id].modbus.kind == config::ModbusKind::holding) {
      text += fmt::format("  mbpoll -m tcp -p {} -a {} -0 -t 4 -r {} -1 {}{}   # {}\n", endpoint.port, *drive.unit,
                          drive.signals[*id].modbus.address, endpoint.host, value, signal);
    }
  };
  add("status_word", "");
  add("output_frequency", "");
  add("actual_velocity", "");
  if (const ControlWords* const words = control_words(drive); words != nullptr && !words->staged) {
    add("frequency_command", " 2500");
    add("control_command", fmt::format(" {}", words->run));
  }
}

// As it is found in another terminal, installed or not.
std::string own_path() {
  std::error_code failed;
  const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", failed);
  return failed ? "canopen-gateway" : path.string();
}

// The same by the program itself, through the control socket.
std::string control_lines(const config::Model& model) {
  const std::string& socket = model.gateway.control;
  const std::string program = own_path();
  std::string text = fmt::format("\nHow everything is:\n  {} status --control {}\n", program, socket);
  for (const config::Drive& drive : model.drives) {
    const ControlWords* const words = control_words(drive);
    if (words != nullptr && !words->staged && drive.commands.writers.local) {
      return text +
             fmt::format("  {} set {} {}={:.1f} control_command={} --control {}   # run\n", program, drive.name,
                         words->setpoint, words->example, words->run, socket) +
             fmt::format("  {} stop --control {}   # all of them\n", program, socket);
    }
  }
  return text;
}

std::string http_address(const config::Endpoint& endpoint) {
  const bool is_v6 = endpoint.host.find(':') != std::string::npos;
  return is_v6 ? fmt::format("http://[{}]:{}", endpoint.host, endpoint.port)
               : fmt::format("http://{}:{}", endpoint.host, endpoint.port);
}

}  // namespace

DemoScreen::DemoScreen(const boost::asio::any_io_executor& executor, const process::Plant& plant, Output out,
                       bool often)
    : plant_(plant), out_(std::move(out)), timer_(executor), period_(often ? kOften : kSeldom) {}

void DemoScreen::start() {
  out_(demo_guide(plant_.model()));
  show();
}

void DemoScreen::stop() {
  timer_.cancel();
}

void DemoScreen::show() {
  timer_.expires_after(period_);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (error) {
      return;
    }
    out_(demo_table(plant_, canopen::Clock::now()));
    show();
  });
}

std::string demo_guide(const config::Model& model) {
  const std::size_t drives = model.drives.size();
  std::string text = fmt::format("{} simulated {} and the gateway on an in-process CAN bus.\n", drives,
                                 drives == 1 ? "drive" : "drives");
  text +=
      fmt::format("Here, `{0} fault 4` trips node {0}, and `help` lists what else can be done. In another terminal:\n",
                  model.drives.front().node.node);
  text += control_lines(model);
  if (model.mqtt) {
    text += fmt::format("\nEverything the gateway publishes:\n  mosquitto_sub -h {} -p {} -v -t '{}/{}/#'\n",
                        model.mqtt->brokers.front().host, model.mqtt->brokers.front().port, model.mqtt->base,
                        model.gateway.name);
  }
  if (model.http) {
    text += fmt::format(
        "\nThe same to look at, and what Prometheus reads:\n  curl {0}/api/drives/{1}\n  curl {0}/metrics\n",
        http_address(model.http->listen), model.drives.front().name);
  }
  for (const config::Drive& drive : model.drives) {
    text += fmt::format("\n{} ({}, node {}):\n", drive.name, drive.profile, drive.node.node);
    if (model.modbus && drive.unit) {
      add_modbus_lines(text, model, drive);
    }
    if (model.mqtt) {
      add_mqtt_lines(text, model, drive);
    }
  }
  return text + "\n";
}

std::string demo_table(const process::Plant& plant, canopen::TimePoint now) {
  std::string text;
  for (std::size_t i = 0; i < plant.size(); ++i) {
    const process::Drive& drive = plant.drive(i);
    text += fmt::format("{:<8} {:<16}", drive.model().name, state_of(drive));
    for (const std::string_view name :
         {"running", "output_frequency", "actual_velocity", "motor_speed", "output_current", "dc_bus_voltage"}) {
      if (const std::string value = value_of(drive, name, now); !value.empty()) {
        text += "  " + value;
      }
    }
    text += alarms_of(drive) + "\n";
  }
  return text + "\n";
}

}  // namespace gateway
