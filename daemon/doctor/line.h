#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gateway::doctor {

enum class Verdict : std::uint8_t {
  ok,
  warning,  ///< It works, or may work later, but somebody should look.
  error     ///< The gateway cannot do its work like this.
};

/// One thing that was looked at.
struct Line {
  Verdict verdict = Verdict::ok;
  std::string subject;   ///< `bus can0`, `port 0.0.0.0:502`
  std::string finding;   ///< What is the case.
  std::string remedy{};  ///< What to do; never empty but where all is well.
};
using Lines = std::vector<Line>;

/// Each a line, the remedy behind it in one of its own; then how many warnings and errors there are.
[[nodiscard]] std::string to_text(const Lines& lines);
[[nodiscard]] bool has_error(const Lines& lines) noexcept;

}  // namespace gateway::doctor
