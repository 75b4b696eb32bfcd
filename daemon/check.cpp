#include <unistd.h>

#include "config/longest_restart.h"
#include "daemon/commands.h"
#include "daemon/descriptors.h"
#include "daemon/output.h"

namespace gateway {

std::string text_of(const config::Findings& findings) {
  std::string text;
  for (const config::Finding& finding : findings) {
    text += with_priority(STDOUT_FILENO, finding.level, to_string(finding)) + "\n";
  }
  return text;
}

int check(const Options& options) {
  const config::Loaded loaded = config::load(load_options(options));
  std::string text = text_of(loaded.findings);
  if (loaded.model) {
    text += config::longest_restart(loaded) + "\n" + config::summary(*loaded.model) + "\n";
  }
  print(text);
  return loaded.model ? kDone : kConfigurationError;
}

}  // namespace gateway
