#include "daemon/commands.h"
#include "daemon/descriptors.h"
#include "daemon/map.h"
#include "daemon/output.h"

namespace gateway {

int show_map(const Options& options, const std::string& format) {
  const std::optional<config::Model> model = load_or_complain(options, Secrets::leave);
  if (!model) {
    return kConfigurationError;
  }
  const std::optional<MapFormat> wanted = parse_map_format(format);
  if (!wanted) {
    complain("unknown format " + format);
    return kUsage;
  }
  print(render_map(*model, *wanted));
  return kDone;
}

}  // namespace gateway
