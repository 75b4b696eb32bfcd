#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "bridges/disk/descriptor.h"

namespace recorder {

/// The calls that a disk can hang in or refuse: like write(2), fsync(2) and renameat(2) within one directory, errno
/// included. Tests have their own.
struct DiskCalls {
  /// Of a file system, in bytes.
  struct Space {
    std::uint64_t all = 0;
    std::uint64_t left = 0;  ///< For us.
  };
  std::function<ssize_t(int descriptor, const char* bytes, std::size_t size)> write;
  std::function<int(int descriptor)> sync;
  std::function<int(int directory, const char* from, const char* to)> rename;
  /// Like unlinkat(2) of a file.
  std::function<int(int directory, const char* name)> remove;
  /// Of the file system of that directory; nothing where it does not tell.
  std::function<std::optional<Space>(int directory)> space;
  static DiskCalls real();
};

/// What is wrong, for people; nothing: all is well. It names no record, so that it is the same for all that fail alike.
using Failure = std::optional<std::string>;

/// `WHAT: REASON`, with the reason that errno tells.
[[nodiscard]] std::string failed(const std::string& what);

/// A file that has its name only once it is whole and on the disk. Until then, and where it never comes to that, it is
/// `NAME.new`, which is removed with the object.
class WholeFile {
 public:
  /// `directory`, an open one, and `calls` outlive it.
  WholeFile(int directory, std::string name, const DiskCalls& calls);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  [[nodiscard]] Failure open();
  /// Is gathered, and written a piece at a time.
  [[nodiscard]] Failure append(std::string_view text);
  /// All of it is on the disk.
  [[nodiscard]] Failure sync();
  /// After sync(). For that to last the directory is to be synced.
  [[nodiscard]] Failure name();
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// What failed did so for want of room on the disk.
  [[nodiscard]] bool met_full_disk() const noexcept { return met_full_disk_; }

 private:
  [[nodiscard]] Failure flush();
  /// failed(), and what for is remembered.
  [[nodiscard]] Failure fail(const std::string& what);

  int directory_;
  std::string name_;
  std::string new_name_;
  const DiskCalls& calls_;
  disk::Descriptor file_;
  std::string waiting_;
  std::uint64_t size_ = 0;
  bool named_ = false;
  bool met_full_disk_ = false;
};

}  // namespace recorder
