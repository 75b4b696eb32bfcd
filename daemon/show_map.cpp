#include <iostream>

#include "daemon/commands.h"
#include "daemon/map.h"

namespace gateway {

int show_map(const Options& options, const std::string& format) {
  const std::optional<config::Model> model = load_or_complain(options);
  if (!model) {
    return kConfigurationError;
  }
  const std::optional<MapFormat> wanted = parse_map_format(format);
  if (!wanted) {
    std::cerr << "unknown format " << format << '\n';
    return kUsage;
  }
  std::cout << render_map(*model, *wanted);
  return kDone;
}

}  // namespace gateway
