#include <unistd.h>

#include "daemon/commands.h"
#include "daemon/descriptors.h"
#include "daemon/output.h"

namespace gateway {

int check(const Options& options) {
  const config::Loaded loaded = config::load(load_options(options));
  std::string text;
  for (const config::Finding& finding : loaded.findings) {
    text += with_priority(STDOUT_FILENO, finding.level, to_string(finding)) + "\n";
  }
  if (loaded.model) {
    text += config::summary(*loaded.model) + "\n";
  }
  print(text);
  return loaded.model ? kDone : kConfigurationError;
}

}  // namespace gateway
