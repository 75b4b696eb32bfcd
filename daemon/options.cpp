#include "daemon/options.h"

#include <unistd.h>

#include <array>
#include <chrono>
#include <string>

#include "daemon/descriptors.h"
#include "daemon/output.h"

namespace gateway {
namespace {

// The first label only: a gateway is named line3, not line3.plant.example.
std::string host_name() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) {
    return "gateway";
  }
  const std::string full(name.data());
  return full.substr(0, full.find('.'));
}

}  // namespace

config::LoadOptions load_options(const Options& options) {
  config::LoadOptions load;
  load.file = options.config;
  load.profile_dirs = options.profile_dirs;
  load.profile_dirs.emplace_back("/etc/canopen-gateway/profiles");
  load.profile_dirs.emplace_back(GATEWAY_PROFILE_DIR);
  load.host_name = host_name();
  return load;
}

void show_findings(const config::Findings& findings) {
  std::string text;
  for (const config::Finding& finding : findings) {
    text += with_priority(STDERR_FILENO, finding.level, to_string(finding)) + '\n';
  }
  // Not by a stream, which gives up when a signal comes while it waits for its reader. Nobody can be told of a failure.
  constexpr std::chrono::milliseconds kForEver(-1);
  static_cast<void>(write_text(STDERR_FILENO, text, kForEver));
}

std::optional<config::Model> load_or_complain(const Options& options, Secrets secrets) {
  config::LoadOptions load = load_options(options);
  load.with_secrets = secrets == Secrets::read;
  config::Loaded loaded = config::load(load);
  show_findings(loaded.findings);
  return std::move(loaded.model);
}

}  // namespace gateway
