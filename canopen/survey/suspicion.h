#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "canopen/bus/bus_state.h"
#include "canopen/clock.h"
#include "canopen/survey/recent_traffic.h"

namespace canopen {

/// What may be wrong with a bus, the one that explains most first.
enum class SuspicionKind : std::uint8_t { doubled_id, alone, bit_rate, wiring, overload };

inline constexpr std::array kSuspicionKinds{SuspicionKind::doubled_id, SuspicionKind::alone, SuspicionKind::bit_rate,
                                            SuspicionKind::wiring, SuspicionKind::overload};

/// `doubled_id`, `alone`, `bit_rate`, `wiring`, `overload`.
[[nodiscard]] std::string_view name_of(SuspicionKind kind) noexcept;

/// For people, never as a certainty: `the gateway may be alone on the bus`.
[[nodiscard]] std::string_view describe(SuspicionKind kind) noexcept;

/// A node id that somebody else seems to have, too.
struct DoubledSign {
  std::uint8_t node = 0;
  std::string text;  ///< By what that is known.
};

/// What a bus shows, for judge().
struct Signs {
  BusState state{};
  BusTroubles troubles{};
  RecentTraffic::Sum lately{};  ///< Of the last kLately seconds.
  RecentTraffic::Sum minute{};  ///< Of the last minute.
  bool heard_before = false;    ///< A frame of others since the interface came up, or the gateway opened it.
  bool saw_it_come_up = false;  ///< Else it may have been up, and frames received, before the gateway opened it.
  std::uint32_t bus_offs = 0;   ///< In the last minute.
  /// The controller left error-active kExcursions times in kExcursionsWithin and came back, each time with nobody
  /// missing who would have acknowledged.
  bool excursions = false;
  std::uint16_t load_per_mille = 0;
  std::uint32_t bitrate = 0;  ///< bit/s; 0: not known.
  std::optional<DoubledSign> doubled{};
  std::string busiest{};  ///< `0x181, every 2 ms`; empty: not known.

  static constexpr std::size_t kLately = 10;
};

/// So many times within that time it is more than a plug that was moved, or a drive that was switched.
inline constexpr std::size_t kExcursions = 3;
inline constexpr Duration kExcursionsWithin = std::chrono::minutes(10);

struct Suspicion {
  SuspicionKind kind{};
  std::string seen;  ///< What was seen.
  std::string look;  ///< What to look at first, and then.

  /// All of it as sentences. `age`: stands behind what is suspected.
  [[nodiscard]] std::string text(std::string_view age = {}) const;
  friend bool operator==(const Suspicion&, const Suspicion&) = default;
};

/// The pattern that the signs show; nothing where they show none that is known, or the interface is down.
/// docs/BUS_HEALTH.md has the table.
[[nodiscard]] std::optional<Suspicion> judge(const Signs& signs);

}  // namespace canopen
