#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <utility>

#include "daemon/commands.h"
#include "daemon/control/exchange.h"
#include "daemon/doctor/files.h"
#include "daemon/doctor/hearing.h"
#include "daemon/doctor/interface.h"
#include "daemon/doctor/line.h"
#include "daemon/doctor/machine.h"
#include "daemon/doctor/network.h"
#include "daemon/output.h"

namespace gateway {
namespace {

using doctor::Line;
using doctor::Lines;
using doctor::Verdict;

constexpr std::chrono::milliseconds kPatience(3000);

void append(Lines& lines, Lines more) {
  for (Line& line : more) {
    lines.push_back(std::move(line));
  }
}

Line judge_configuration(const config::Loaded& loaded, const std::filesystem::path& file) {
  std::size_t errors = 0;
  std::size_t warnings = 0;
  for (const config::Finding& finding : loaded.findings) {
    ++(finding.level == config::Finding::Level::error ? errors : warnings);
  }
  if (!loaded.model) {
    return {Verdict::error, "configuration",
            fmt::format("{}: {} error{}", file.string(), errors, errors == 1 ? "" : "s"),
            "`canopen-gateway check` names each; what needs a configuration was not looked at"};
  }
  if (warnings > 0) {
    return {Verdict::warning, "configuration",
            fmt::format("{}: {} warning{}", file.string(), warnings, warnings == 1 ? "" : "s"),
            "`canopen-gateway check` names each"};
  }
  return {Verdict::ok, "configuration", file.string()};
}

Line ask_gateway(const std::filesystem::path& socket, bool& runs) {
  runs = false;
  if (socket.empty()) {
    return {Verdict::warning, "gateway", "`control` is empty: whether it runs was not asked",
            "without a control socket `status`, `set` and `stop` of this program do not work either"};
  }
  const control::Exchanged answer = control::exchange(socket, R"({"id":1,"op":"status"})", kPatience);
  if (!answer.problem.empty()) {
    return {Verdict::warning, "gateway", "it does not answer: " + answer.problem.substr(0, answer.problem.find(';')),
            "`systemctl status canopen-gateway`, `journalctl -u canopen-gateway`; as another user run this as root"};
  }
  runs = true;
  return {Verdict::ok, "gateway", "it runs and answers; `canopen-gateway status` shows its drives"};
}

void look_at_buses(Lines& lines, const config::Model& model, const doctor::Listened& listened) {
  for (std::size_t i = 0; i < model.buses.size(); ++i) {
    const config::Bus& bus = model.buses[i];
    const std::string subject = "bus " + bus.name;
    if (bus.interface == config::kVirtualInterface) {
      lines.push_back({Verdict::ok, subject, "it lives inside the gateway"});
      continue;
    }
    const doctor::InterfaceFacts facts = doctor::look_at_interface(bus.interface);
    append(lines, judge(bus, facts));
    if (!facts.interface || !facts.is_can || !facts.interface->administratively_up) {
      continue;
    }
    std::error_code failed;
    const doctor::Hearing hearing = doctor::listen(bus.interface, listened.time, failed);
    if (failed) {
      lines.push_back({Verdict::error, subject, "cannot listen: " + failed.message(),
                       "look at what confines this process, and at `ip link show " + bus.interface + "`"});
    } else {
      append(lines, judge(model, i, hearing, listened));
    }
  }
}

void look_at_network(Lines& lines, const config::Model& model, bool gateway_runs) {
  const doctor::PortHolder holder{.gateway_runs = gateway_runs, .privileged = ::geteuid() == 0};
  std::vector<config::Endpoint> ports;
  if (model.modbus) {
    ports = model.modbus->listen;
  }
  if (model.http) {
    ports.push_back(model.http->listen);
  }
  for (const config::Endpoint& listen : ports) {
    lines.push_back(judge(listen, doctor::try_port(listen), holder));
  }
  if (model.mqtt) {
    for (const config::Endpoint& broker : model.mqtt->brokers) {
      lines.push_back(judge(broker, doctor::try_broker(*model.mqtt, broker, kPatience)));
    }
  }
}

}  // namespace

int examine(const Options& options, std::chrono::milliseconds listening) {
  const config::LoadOptions load = load_options(options);
  const config::Loaded loaded = config::load(load);
  Lines lines{judge_configuration(loaded, options.config)};
  append(lines, judge(doctor::look_at_machine()));
  if (loaded.model) {
    bool gateway_runs = false;
    lines.push_back(ask_gateway(loaded.model->gateway.control, gateway_runs));
    const std::vector<doctor::Wanted> files = doctor::wanted_files(*loaded.model, options.config, load.profile_dirs);
    append(lines, judge(files, try_files(files)));
    look_at_buses(lines, *loaded.model, {.time = listening, .gateway_runs = gateway_runs});
    look_at_network(lines, *loaded.model, gateway_runs);
  }
  print(doctor::to_text(lines));
  return has_error(lines) ? kFailed : kDone;
}

}  // namespace gateway
