#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bridges/journal/line.h"
#include "canopen/clock.h"

namespace journal {

/// A command that has ended; texts are JSON members without braces.
struct Ended {
  canopen::WallTime wall;
  canopen::TimePoint at;
  std::string who;   ///< Of whom, to which drive, and the outcome's code.
  std::string what;  ///< Id, fields, result.
};

/// The line of one command, and of several of one kind.
[[nodiscard]] Entry line_of(const Ended& ended);

/// Commands of one kind that come often are one line a minute. The first of them has its own line at once; those of the
/// minute after it are counted, and so on as long as there are some.
class Repeats {
 public:
  /// The line to be written now; nothing: it is counted. `kind`: what makes two of them the same.
  [[nodiscard]] std::optional<Entry> add(const std::string& kind, Ended ended);
  /// Lines of the minutes that are over.
  [[nodiscard]] std::vector<Entry> take_due(canopen::TimePoint now);
  /// Lines of all that was counted so far.
  [[nodiscard]] std::vector<Entry> take_all();
  /// When the next minute is over; canopen::kNever where none runs.
  [[nodiscard]] canopen::TimePoint due() const noexcept;
  /// The minute of this kind runs.
  [[nodiscard]] bool knows(const std::string& kind) const { return kinds_.contains(kind); }
  /// Kinds whose minute runs.
  [[nodiscard]] std::size_t size() const noexcept { return kinds_.size(); }

 private:
  struct Counted {
    canopen::TimePoint until;
    std::uint64_t count = 0;
    std::optional<Ended> first{};
    std::optional<Ended> last{};
  };

  [[nodiscard]] static Entry line_of_counted(const Counted& counted);

  std::map<std::string, Counted> kinds_;
};

}  // namespace journal
