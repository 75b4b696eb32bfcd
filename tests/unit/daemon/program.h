#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tests/unit/daemon/descriptor.h"

namespace gateway::test {

/// canopen-gateway as a process of its own, with standard input at its end. No wait is longer than 30 s.
class Program {
 public:
  enum class Output : std::uint8_t { plain, journal };
  /// `variables`: `NAME=value`, in its environment besides ours. `output`: what that counts as which it writes.
  explicit Program(const std::vector<std::string>& arguments, const std::vector<std::string>& variables = {},
                   Output output = Output::plain);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void signal(int number) const;
  /// Waits until it has written that, to standard output or standard error, behind what was found by the call before.
  /// False when it ends without.
  [[nodiscard]] bool says(std::string_view text);
  /// Waits for its end. The exit code, or minus the signal that ended it.
  [[nodiscard]] int exit_code();
  /// What it has written so far.
  [[nodiscard]] const std::string& output() const noexcept { return output_; }

 private:
  bool read_on();

  pid_t process_ = 0;
  Descriptor reading_;
  std::string output_;
  std::size_t found_ = 0;
};

/// A file in the directory for temporary ones, removed with it.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::string_view content);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace gateway::test
