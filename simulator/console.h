#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "simulator/drive.h"

namespace simulator {

/// Makes drives misbehave by lines of text, `NODE VERB [ARGUMENT...]`; `help` lists them.
/// The drives outlive it.
class Console {
 public:
  /// False when a drive with this node is there already.
  bool add(Drive& drive);

  /// One line in, one answer out, without a newline at its end (`help` and `list` answer several lines). The answer to
  /// an order is "ok"; a bad line changes nothing and answers "error: ..." with the remedy. An empty line and one that
  /// starts with # answer nothing.
  [[nodiscard]] std::string execute(std::string_view line);

  [[nodiscard]] static std::string help();

 private:
  [[nodiscard]] std::vector<Drive*> drives_of(std::string_view word) const;
  [[nodiscard]] std::string nodes() const;
  [[nodiscard]] static std::string show(const std::vector<Drive*>& drives);

  std::map<std::uint8_t, Drive*> drives_;
};

}  // namespace simulator
