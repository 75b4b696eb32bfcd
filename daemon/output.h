#pragma once

#include <chrono>
#include <functional>
#include <string_view>
#include <system_error>

namespace gateway {

/// Writes the whole text to a descriptor. One that does not block is waited for, each time for at most `patience`
/// (negative: for ever); then the rest is lost and the answer is errc::timed_out. What else it answers is the system's:
/// no_space_on_device, broken_pipe (where SIGPIPE is ignored).
[[nodiscard]] std::error_code write_text(int descriptor, std::string_view text, std::chrono::milliseconds patience);

/// Writes the whole text to standard output. @throws std::system_error
void print(std::string_view text);

/// Standard output of a command that goes on for long. Text that a stalled terminal does not take is lost where its
/// descriptor does not block (it does so while standard input is the same terminal), since the
/// gateway must not wait for it; any other failure is final.
class LiveOutput {
 public:
  /// Short against every heartbeat: the drives of a demo must not be lost because its terminal stands still.
  static constexpr std::chrono::milliseconds kPatience{100};

  /// `on_failure` is called once; nothing is written after that.
  LiveOutput(int descriptor, std::function<void()> on_failure, std::chrono::milliseconds patience = kPatience);

  void write(std::string_view text);
  /// @throws std::system_error where writing has failed.
  void require_written() const;

 private:
  int descriptor_;
  std::function<void()> on_failure_;
  std::chrono::milliseconds patience_;
  std::error_code failure_;
};

}  // namespace gateway
