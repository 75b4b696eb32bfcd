#pragma once

#include <optional>
#include <vector>

#include "config/drive_notes.h"
#include "config/schema/section.h"

namespace config {

/// One `[[live]]`.
struct LiveKeys {
  LiveCheck check;  ///< What is plainly said of it.
  std::optional<canopen::ObjectAddress> object;
  std::optional<canopen::DataType> type;
  std::optional<std::int64_t> mask;
  std::vector<std::int64_t> equals;
};
[[nodiscard]] const SectionOf<LiveKeys>& live_section();

/// `[trial]`
[[nodiscard]] const SectionOf<Trial>& trial_section();

}  // namespace config
