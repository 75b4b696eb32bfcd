#include "daemon/control/find_daemon.h"

#include <algorithm>
#include <system_error>

namespace gateway::control {
namespace {

std::chrono::milliseconds longest_deadline(const config::Model& model) {
  canopen::Duration longest{};
  for (const config::Drive& drive : model.drives) {
    longest = std::max(longest, drive.commands.deadline);
  }
  return std::chrono::ceil<std::chrono::milliseconds>(longest);
}

}  // namespace

std::optional<Daemon> find_daemon(const Reach& reach) {
  Daemon daemon{.socket = reach.socket};
  if (!daemon.socket.empty()) {
    return daemon;
  }
  daemon.socket = config::Gateway{}.control;
  std::error_code ignored;
  if (!reach.options.config_given && !std::filesystem::exists(reach.options.config, ignored)) {
    return daemon;
  }
  const config::Loaded loaded = config::load(load_options(reach.options));
  if (loaded.model) {
    daemon.socket = loaded.model->gateway.control;
    daemon.patience = longest_deadline(*loaded.model) + Daemon::kGrace;
  } else if (reach.options.config_given) {
    show_findings(loaded.findings);
    return std::nullopt;
  }
  return daemon;
}

}  // namespace gateway::control
