#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <optional>
#include <utility>

#include "daemon/commands.h"
#include "daemon/doctor/files.h"
#include "daemon/doctor/hearing.h"
#include "daemon/doctor/interface.h"
#include "daemon/doctor/line.h"
#include "daemon/doctor/machine.h"
#include "daemon/doctor/network.h"
#include "daemon/doctor/presence.h"
#include "daemon/doctor/service.h"
#include "daemon/output.h"

namespace gateway {
namespace {

using doctor::Line;
using doctor::Lines;
using doctor::Verdict;

constexpr std::chrono::milliseconds kAnswerPatience(3000);

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

// `listening`: nothing: as long as each bus needs.
void look_at_buses(Lines& lines, const config::Model& model, std::optional<std::chrono::milliseconds> listening,
                   doctor::Presence gateway) {
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
    const doctor::Listened listened{.time = listening.value_or(doctor::listening_time(model, i)), .gateway = gateway};
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

void look_at_ports(Lines& lines, const config::Model& model, const doctor::ServiceFacts& service,
                   doctor::Presence presence, pid_t gateway) {
  const auto look = [&](const config::Endpoint& listen, bool may_be_passed) {
    lines.push_back(judge(listen, doctor::try_port(listen, gateway),
                          {.gateway = presence,
                           .privileged = ::geteuid() == 0,
                           .opener = opener_of(listen, service, may_be_passed),
                           .may_be_passed = may_be_passed}));
  };
  if (model.modbus) {
    for (const config::Endpoint& listen : model.modbus->listen) {
      look(listen, true);
    }
  }
  if (model.http) {
    look(model.http->listen, false);
  }
}

// `lacks_files`: as try_broker() has it.
void look_at_brokers(Lines& lines, const config::Mqtt& mqtt, bool lacks_files) {
  for (const config::Endpoint& broker : mqtt.brokers) {
    lines.push_back(judge(broker, doctor::try_broker(mqtt, broker, lacks_files, kAnswerPatience)));
  }
}

void look_at_plant(Lines& lines, const config::Model& model, const std::vector<doctor::Wanted>& files,
                   std::optional<std::chrono::milliseconds> listening) {
  const doctor::GatewayFacts gateway = doctor::ask_gateway(model.gateway.control, kAnswerPatience);
  const doctor::Presence presence = presence_of(model.gateway.control, gateway);
  lines.push_back(judge(model.gateway.control, gateway));
  const doctor::FileFacts file_facts = try_files(files);
  append(lines, judge(files, file_facts));
  const doctor::ServiceFacts service = doctor::look_at_service(doctor::unit_directories());
  append(lines, judge(service, files, model.gateway.control));
  look_at_buses(lines, model, listening, presence);
  look_at_ports(lines, model, service, presence, gateway.process);
  if (model.mqtt) {
    look_at_brokers(
        lines, *model.mqtt,
        lacks_credential(files, file_facts, {model.mqtt->ca_file, model.mqtt->cert_file, model.mqtt->key_file}));
  }
}

}  // namespace

int examine(const Options& options, std::optional<std::chrono::milliseconds> listening) {
  const config::LoadOptions load = load_options(options);
  const config::Loaded loaded = config::load(load);
  Lines lines{judge_configuration(loaded, options.config)};
  append(lines, judge(doctor::look_at_machine()));
  if (loaded.model) {
    look_at_plant(lines, *loaded.model, doctor::wanted_files(*loaded.model, options.config, load.profile_dirs),
                  listening);
  }
  print(doctor::to_text(lines));
  return has_error(lines) ? kFailed : kDone;
}

}  // namespace gateway
