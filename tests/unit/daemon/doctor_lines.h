#pragma once

#include <gtest/gtest.h>

#include <string>
#include <system_error>

#include "daemon/doctor/line.h"

namespace gateway::doctor {

inline std::error_code error_of(std::errc code) {
  return std::make_error_code(code);
}

/// The verdict of the line that says `part`; without one, all there are.
inline std::string find(const Lines& lines, const std::string& part) {
  for (const Line& line : lines) {
    if (line.finding.find(part) != std::string::npos) {
      EXPECT_EQ(line.remedy.empty(), line.verdict == Verdict::ok) << line.finding;
      return std::string(line.verdict == Verdict::ok ? "ok" : line.verdict == Verdict::warning ? "warning" : "error");
    }
  }
  return to_text(lines);
}

}  // namespace gateway::doctor
