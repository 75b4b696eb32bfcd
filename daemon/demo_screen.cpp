#include "daemon/demo_screen.h"

#include <fmt/format.h>

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

/// A drive with what its profile says of how to try it.
struct Tried {
  const config::Drive& drive;
  const config::Trial& trial;

  [[nodiscard]] bool can_run() const {
    return !trial.run.empty() && !trial.setpoint.empty() && drive.find(trial.setpoint).has_value();
  }
  /// Other values come before the one that runs it (CiA 402: shutdown, switch on).
  [[nodiscard]] bool in_steps() const noexcept { return trial.run.size() > 1; }
};

// Of a control command, as it is commanded: named where the site knows its names.
std::string command_of(const config::Drive& drive, std::int64_t value) {
  const auto id = drive.find("control_command");
  if (id) {
    const auto& names = drive.signals[*id].values;
    if (const auto name = names.find(value); name != names.end()) {
      return name->second;
    }
  }
  return std::to_string(value);
}

// The lines carry no ids: so they may be given again and again.
void add_mqtt_lines(std::string& text, const config::Model& model, const Tried& tried) {
  const config::Drive& drive = tried.drive;
  const config::Trial& trial = tried.trial;
  if (!tried.can_run()) {
    return;
  }
  const std::string at = fmt::format("-h {} -p {}", model.mqtt->brokers.front().host, model.mqtt->brokers.front().port);
  const std::string topics = model.mqtt->base + "/" + model.gateway.name + "/" + drive.name;
  const std::string to = fmt::format("  mosquitto_pub {} -t {}", at, topics);
  const std::string alarm = fmt::format("  mosquitto_sub {} -C 1 -t {}/alarm/emcy\n", at, topics);
  const auto add_command = [&](std::int64_t value, std::string_view comment) {
    text += fmt::format("{}/control_command/set -m {}{}\n", to, value, comment);
  };
  for (std::size_t i = 0; i + 1 < trial.run.size(); ++i) {
    add_command(trial.run[i], "   # before it runs");
  }
  text += fmt::format("{}/set -m '{{\"{}\":{:.1f},\"control_command\":{}}}'   # run\n", to, trial.setpoint, trial.value,
                      trial.run.back());
  if (const auto stop = canopen::first_stop(drive.node.motor)) {
    add_command(static_cast<std::int64_t>(*stop), "   # stop");
  }
  if (drive.commands.raw) {  // A fault from outside: the simulated drives' own object, reached by an SDO request.
    text += fmt::format(
        "{}/sdo/request -m '{{\"op\":\"write\",\"object\":\"{}\",\"type\":\"u16\",\"value\":5}}'   # it trips\n", to,
        to_string(canopen::ObjectAddress{simulator::kTroubleObject.index, simulator::kTroubleObject.sub}));
    text += alarm;
  }
  for (std::size_t i = 0; i < trial.reset.size(); ++i) {
    add_command(trial.reset[i], i + 1 < trial.reset.size() ? "   # before a fault reset" : "   # fault reset");
  }
  text += alarm;
}

void add_modbus_lines(std::string& text, const config::Model& model, const Tried& tried) {
  const config::Drive& drive = tried.drive;
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
  if (const auto setpoint = drive.find(tried.trial.setpoint); setpoint && tried.can_run() && !tried.in_steps()) {
    add(tried.trial.setpoint, fmt::format(" {:.0f}", tried.trial.value / drive.signals[*setpoint].scale));
    add("control_command", fmt::format(" {}", tried.trial.run.back()));
  }
}

// As it is found in another terminal, installed or not.
std::string own_path() {
  std::error_code failed;
  const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", failed);
  return failed ? "canopen-gateway" : path.string();
}

// The same by the program itself, through the control socket.
std::string control_lines(const config::Model& model, std::span<const config::DriveNotes> notes) {
  const std::string& socket = model.gateway.control;
  const std::string program = own_path();
  std::string text = fmt::format("\nHow everything is:\n  {} status --control {}\n", program, socket);
  for (std::size_t i = 0; i < model.drives.size(); ++i) {
    const Tried tried{model.drives[i], notes[i].trial};
    const config::Drive& drive = tried.drive;
    if (tried.can_run() && !tried.in_steps() && drive.commands.writers.local) {
      return text +
             fmt::format("  {} set {} {}={:.1f} control_command={} --control {}   # run\n", program, drive.name,
                         tried.trial.setpoint, tried.trial.value, command_of(drive, tried.trial.run.back()), socket) +
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

DemoScreen::DemoScreen(const boost::asio::any_io_executor& executor, const process::Plant& plant, std::string guide,
                       Output out, bool often)
    : plant_(plant),
      guide_(std::move(guide)),
      out_(std::move(out)),
      timer_(executor),
      period_(often ? kOften : kSeldom) {}

void DemoScreen::start() {
  out_(guide_);
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

std::string demo_guide(const config::Model& model, std::span<const config::DriveNotes> notes) {
  const std::size_t drives = model.drives.size();
  std::string text;
  if (model.http) {
    text += fmt::format("The page: {}/\n", http_address(model.http->listen));
  }
  text += fmt::format("{} simulated {} and the gateway on an in-process CAN bus.\n", drives,
                      drives == 1 ? "drive" : "drives");
  text +=
      fmt::format("Here, `{0} fault 4` trips node {0}, and `help` lists what else can be done. In another terminal:\n",
                  model.drives.front().node.node);
  text += control_lines(model, notes);
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
  for (std::size_t i = 0; i < drives; ++i) {
    const config::Drive& drive = model.drives[i];
    const Tried tried{drive, notes[i].trial};
    text += fmt::format("\n{} ({}, node {}):\n", drive.name, drive.profile, drive.node.node);
    if (model.modbus && drive.unit) {
      add_modbus_lines(text, model, tried);
    }
    if (model.mqtt) {
      add_mqtt_lines(text, model, tried);
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
