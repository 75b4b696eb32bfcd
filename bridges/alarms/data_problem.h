#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace alarms {

/// Why a drive's values or its emergencies cannot be had; the words of the alarm `data`, docs/ALARMS.md.
enum class DataReason : std::uint8_t {
  overdue,     ///< A TPDO does not come while the drive lives.
  unreadable,  ///< The same, or one on change that never came, and its objects could not be read in its place.
  too_short,   ///< A TPDO is shorter than its mapping.
  absent,      ///< The drive does not have an object that is polled.
  emcy_off,    ///< Emergencies are switched off in 0x1014.
  emcy_moved   ///< They come under another COB-ID.
};
/// `overdue`, `unreadable`, `short`, `absent`, `emcy-off`, `emcy-moved`.
[[nodiscard]] std::string_view name_of(DataReason reason) noexcept;

struct DataProblem {
  DataReason reason = DataReason::overdue;
  std::string text;  ///< For people: what, and where.
  friend bool operator==(const DataProblem&, const DataProblem&) = default;
};

}  // namespace alarms
