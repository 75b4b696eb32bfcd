#pragma once

#include <functional>
#include <map>
#include <string>

#include "canopen/clock.h"

namespace disk {

/// Tells of something that does not work: at its begin, when it becomes something else, at its end; and no text of
/// these but the end more often than once a minute.
class Trouble {
 public:
  using Told = std::function<void(const std::string&)>;
  explicit Trouble(Told told) : told_(std::move(told)) {}

  /// It does not work now.
  void stands(const std::string& what, canopen::TimePoint now);
  /// It works again. `what` is told where the begin was.
  void is_over(const std::string& what);

 private:
  Told told_;
  std::string standing_;                            ///< As it was told; empty: nothing was.
  std::map<std::string, canopen::TimePoint> when_;  ///< Told within the last minute.
};

}  // namespace disk
