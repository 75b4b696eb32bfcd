#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace trace {

/// What a frame is for: what a reader of the trace chooses by.
enum class Kind : std::uint8_t {
  nmt,
  heartbeat,  ///< Boot-up, heartbeat, guarding.
  sdo,
  pdo,
  emcy,
  sync,
  error,  ///< Told by the driver, or frames that were lost; never on the wire.
  other   ///< TIME, LSS, 29-bit identifiers, and identifiers that CiA 301 gives to nobody.
};
inline constexpr unsigned kKinds = 8;

/// `nmt`, `heartbeat`, …, as a filter writes it.
[[nodiscard]] std::string_view name_of(Kind kind) noexcept;
[[nodiscard]] std::optional<Kind> parse_kind(std::string_view name) noexcept;
/// All names, with commas: for people.
[[nodiscard]] std::string_view kind_names() noexcept;

}  // namespace trace
