#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "daemon/control/ask.h"

namespace gateway::control {

/// How a stream ended.
struct Followed {
  bool interrupted = false;  ///< By SIGINT or SIGTERM: as its user wanted it.
  std::string problem;       ///< Empty: `take` had enough, or the stream was told to be at its end.
};

/// Sends one request to the gateway that listens at `path` and hands on each line that it answers, without its end,
/// until `take` says false, the gateway ends, or a signal comes. The first line comes within `patience`.
[[nodiscard]] Followed follow(const std::filesystem::path& path, std::string_view request,
                              std::chrono::milliseconds patience, const std::function<bool(std::string_view)>& take);

/// The same of a stream for the running daemon of the configuration: `take` gets each line behind the first. Tells what
/// went wrong and returns the exit code: kDone where it was interrupted, kFailed where the gateway ended.
[[nodiscard]] int follow_stream(const Reach& reach, std::string_view request,
                                const std::function<void(std::string_view)>& take);

/// A line of the stream without what stands around it: of `{"id":1,"raw":"…"}` and `raw` it is `"…"`. Empty: it is
/// another line.
[[nodiscard]] std::string_view only_member(std::string_view line, std::string_view name);

}  // namespace gateway::control
