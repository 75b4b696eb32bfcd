#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "bridges/disk/descriptor.h"

namespace alarms {

/// The calls that a disk can hang in or refuse: like read(2), write(2), fsync(2) and rename(2), errno included. Tests
/// have their own.
struct MemoryCalls {
  std::function<ssize_t(int descriptor, char* bytes, std::size_t size)> read;
  std::function<ssize_t(int descriptor, const char* bytes, std::size_t size)> write;
  std::function<int(int descriptor)> sync;
  std::function<int(const char* from, const char* to)> rename;
  static MemoryCalls real();
};

/// `alarms.json` in a state directory, as the one process that uses it sees it. Every call may wait for the disk.
class MemoryFile {
 public:
  /// `directory` is made where it is not there; the one above is not.
  MemoryFile(std::filesystem::path directory, MemoryCalls calls);

  /// What is wrong, for people; nothing: all is well.
  using Failure = std::optional<std::string>;

  /// Takes the directory for this process. The lock goes with it, however it ends.
  [[nodiscard]] Failure open();
  /// After open(). Nothing where there is no file.
  [[nodiscard]] Failure read(std::optional<std::string>& text);
  /// Renames the file to `alarms.json.bad`, in place of an older one.
  [[nodiscard]] Failure set_aside();
  /// open(), then the whole file anew: after a crash at any moment it is the old one or the new one.
  [[nodiscard]] Failure write(std::string_view text);

  static constexpr std::string_view kName = "alarms.json";
  static constexpr std::string_view kBadName = "alarms.json.bad";
  /// No file of ours is so long.
  static constexpr std::size_t kMaxSize = 64UL * 1024 * 1024;

 private:
  [[nodiscard]] Failure write_new(const std::filesystem::path& path, std::string_view text);

  std::filesystem::path directory_;
  MemoryCalls calls_;
  disk::Descriptor lock_;  ///< Of the directory.
};

}  // namespace alarms
