#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

namespace gateway::control {

/// An answer, or why there is none.
struct Exchanged {
  std::string answer;   ///< A line, without its end.
  std::string problem;  ///< With what can be done about it; empty: there is an answer.
};

/// Sends one request to the gateway that listens at `path` and waits for its answer, `patience` at most.
[[nodiscard]] Exchanged exchange(const std::filesystem::path& path, std::string_view request,
                                 std::chrono::milliseconds patience);

}  // namespace gateway::control
