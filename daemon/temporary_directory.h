#pragma once

#include <filesystem>

namespace gateway {

/// A directory of its own for a program that is to leave nothing behind; only its user may look in. Removed with it.
class TemporaryDirectory {
 public:
  /// Throws std::system_error where none can be made.
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace gateway
