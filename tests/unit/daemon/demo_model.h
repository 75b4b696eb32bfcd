#pragma once

#include "config/load.h"
#include "daemon/demo_config.h"

namespace gateway::test {

/// What `demo` runs, without anything that outlives it.
inline config::Model demo_model() {
  const config::LoadOptions options{
      .file = "demo.toml", .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = "host"};
  config::Model model = config::load_text(demo_config(), options).model.value();
  model.gateway.state_dir.clear();
  return model;
}

}  // namespace gateway::test
