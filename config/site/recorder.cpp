#include <optional>

#include "config/site/site.h"
#include "config/site/site_keys.h"
#include "config/toml/document.h"

namespace config {

std::optional<Recorder> read_recorder(const Node& root, const Gateway& gateway, Report& report) {
  const Node* const table = read_table(root, "recorder");
  if (table == nullptr) {
    return std::nullopt;
  }
  if (gateway.state_dir.empty()) {
    report.warning(table->place,
                   "[recorder] has nowhere to keep its records, since gateway.state_dir is empty; nothing is recorded");
  }
  return recorder_section().read(*table);
}

}  // namespace config
