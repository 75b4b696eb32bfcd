#pragma once

#include "config/load.h"
#include "daemon/demo_config.h"

namespace gateway::test {

/// What `demo` runs, with what its profiles tell people.
inline config::Loaded demo_loaded() {
  const config::LoadOptions options{
      .file = "demo.toml", .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = "host"};
  return config::load_text(demo_config(), options);
}

/// What `demo` runs, without anything that outlives it.
inline config::Model demo_model() {
  config::Model model = demo_loaded().model.value();
  model.gateway.state_dir.clear();
  return model;
}

}  // namespace gateway::test
