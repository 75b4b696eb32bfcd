#include <iostream>

#include "daemon/commands.h"

namespace gateway {

int check(const Options& options) {
  const config::Loaded loaded = config::load(load_options(options));
  for (const config::Finding& finding : loaded.findings) {
    std::cout << to_string(finding) << '\n';
  }
  if (!loaded.model) {
    return kConfigurationError;
  }
  std::cout << config::summary(*loaded.model) << '\n';
  return kDone;
}

}  // namespace gateway
