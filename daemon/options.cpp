#include "daemon/options.h"

#include <unistd.h>

#include <array>
#include <iostream>

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

std::optional<config::Model> load_or_complain(const Options& options) {
  config::Loaded loaded = config::load(load_options(options));
  for (const config::Finding& finding : loaded.findings) {
    std::cerr << to_string(finding) << '\n';
  }
  return std::move(loaded.model);
}

}  // namespace gateway
