#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <system_error>

namespace gateway {

/// Writes the whole text to a descriptor. One that does not block is waited for, each time for at most `patience`
/// (negative: for ever); then the rest is lost and the answer is errc::timed_out. What else it answers is the system's:
/// no_space_on_device, broken_pipe (where SIGPIPE is ignored).
[[nodiscard]] std::error_code write_text(int descriptor, std::string_view text, std::chrono::milliseconds patience);

/// Writes the whole text to standard output. @throws std::system_error
void print(std::string_view text);

/// Standard output of a command that goes on for long. The drives of a demo must not be lost because its terminal
/// stands still, so it is never waited for: what it does not take waits for the next write, and is lost only where too
/// much waits. Any other failure is final. Terminals and pipes are written by a descriptor of its own, so that whoever
/// shares the other one does not find it changed.
class LiveOutput {
 public:
  static constexpr std::size_t kMostWaiting = std::size_t{256} * 1024;  ///< Bytes: a quarter of an hour of a demo.
  /// At the end.
  static constexpr std::chrono::milliseconds kPatience{100};

  /// `on_failure` is called once; nothing is written after that.
  LiveOutput(int descriptor, std::function<void()> on_failure);
  ~LiveOutput();
  LiveOutput(const LiveOutput&) = delete;
  LiveOutput& operator=(const LiveOutput&) = delete;

  /// A text for which there is no room is left out as a whole.
  void write(std::string_view text);
  /// Writes what waits, as far as it is taken soon. @throws std::system_error where writing has failed.
  void require_written();

 private:
  void write_on(std::chrono::milliseconds patience);

  int own_;  ///< -1: it could not be had, `descriptor_` is written to.
  int descriptor_;
  std::function<void()> on_failure_;
  std::string waiting_;
  std::error_code failure_;
};

}  // namespace gateway
