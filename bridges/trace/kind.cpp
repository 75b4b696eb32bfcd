#include "bridges/trace/kind.h"

#include <algorithm>
#include <array>

namespace trace {
namespace {

constexpr std::array<std::string_view, kKinds> kNames{"nmt",  "heartbeat", "sdo",   "pdo",
                                                      "emcy", "sync",      "error", "other"};

}  // namespace

std::string_view name_of(Kind kind) noexcept {
  return kNames.at(static_cast<std::size_t>(kind));
}

std::optional<Kind> parse_kind(std::string_view name) noexcept {
  const auto* const found = std::ranges::find(kNames, name);
  return found == kNames.end() ? std::nullopt : std::optional(static_cast<Kind>(found - kNames.begin()));
}

std::string_view kind_names() noexcept {
  return "nmt, heartbeat, sdo, pdo, emcy, sync, error, other";
}

}  // namespace trace
