#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/disk/descriptor.h"
#include "bridges/journal/files.h"
#include "bridges/journal/line.h"

namespace journal {

/// The calls that a disk can hang in or refuse: like write(2) and fdatasync(2), errno included. Tests have their own.
struct FileCalls {
  std::function<ssize_t(int descriptor, const char* bytes, std::size_t size)> write;
  std::function<int(int descriptor)> sync;
  static FileCalls real();
};

/// The files of a journal, as their one writer sees them. Every call may wait for the disk.
class Store {
 public:
  /// `directory` is made where it is not there, and so is the one above. `limit`: bytes of all files together.
  Store(std::filesystem::path directory, std::uint64_t limit, FileCalls calls);

  /// What is wrong, for people; nothing: all is well.
  using Failure = std::optional<std::string>;

  /// Looks how the chain goes on, where that is not known yet. `now`: time of a line about a torn one.
  [[nodiscard]] Failure open(const Entry& now);
  /// Appends a line, after open(). Where that fails nothing of the line counts.
  [[nodiscard]] Failure append(const Entry& entry);
  /// Brings to the disk what was written since the last call. Alone of all may be called from another thread meanwhile.
  [[nodiscard]] Failure sync();

  /// Of the newest line that is written; empty before open().
  [[nodiscard]] const std::string& newest_hash() const noexcept { return hash_; }
  /// The line of the last append(), with its line break.
  [[nodiscard]] const std::string& newest_line() const noexcept { return line_; }

 private:
  [[nodiscard]] Failure open_directory();
  [[nodiscard]] Failure open_newest();
  [[nodiscard]] Failure list_again();
  [[nodiscard]] Failure open_file(const FileName& name);
  [[nodiscard]] Failure end_line();
  [[nodiscard]] Failure seal(const Entry& now);
  [[nodiscard]] Failure rotate(const Entry& entry, std::size_t size);
  [[nodiscard]] Failure make_room(std::size_t size);
  [[nodiscard]] Failure write_line(std::string line);
  [[nodiscard]] Failure write_all(std::string_view bytes);
  [[nodiscard]] bool was_taken_away() const;
  [[nodiscard]] Failure fail(std::string_view what) const;

  std::filesystem::path directory_;
  std::uint64_t limit_;
  FileCalls calls_;
  disk::Descriptor lock_;                ///< Of the directory.
  std::mutex unsynced_;                  ///< Of what sync() needs: the next three, where they change.
  disk::Descriptor file_;                ///< The newest.
  std::vector<disk::Descriptor> older_;  ///< Written to before the newest, not synced since.
  bool written_ = false;                 ///< The newest, likewise.
  std::vector<File> files_;              ///< In order; the last one is `file_`.
  bool torn_ = false;                    ///< Bytes that are no line stand at the end of the newest.
  bool unended_ = false;                 ///< The newest ends in a line that lacks its line break.
  bool known_ = false;                   ///< `n_` and `hash_` say how the chain goes on.
  std::uint64_t n_ = 0;
  std::string hash_;
  std::string line_;
};

}  // namespace journal
