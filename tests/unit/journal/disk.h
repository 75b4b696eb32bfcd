#pragma once

#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "bridges/journal/line.h"
#include "bridges/journal/store.h"

namespace journal {

/// A directory that is gone with the test.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Where the journal's files are.
  [[nodiscard]] std::filesystem::path journal() const { return path_ / "journal"; }

 private:
  std::filesystem::path path_;
};

/// A real disk that a test makes hang and refuse. From any thread.
class Disk {
 public:
  [[nodiscard]] FileCalls calls();

  /// From now on writes wait / go on again.
  void hang();
  void go_on();
  /// Waits until a write hangs.
  void await_hanging();
  /// Writes take `bytes` of what they are given and then refuse with `error`.
  void refuse(int error, std::size_t bytes = 0);
  void accept();
  void refuse_sync(int error);
  [[nodiscard]] std::size_t syncs() const;

 private:
  struct State {
    std::mutex mutex;
    std::condition_variable changed;
    bool hangs = false;
    bool hanging = false;
    int refusal = 0;
    std::size_t taken = 0;
    int sync_refusal = 0;
    std::size_t syncs = 0;
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();  ///< With the calls, which a thread may outlive us with.
};

[[nodiscard]] std::string text_of(const std::filesystem::path& file);
void set_text(const std::filesystem::path& file, const std::string& text);
/// Whole and broken ones, without line breaks.
[[nodiscard]] std::vector<std::string> lines_of(const std::filesystem::path& file);
/// The names of the files, in the order of the chain.
[[nodiscard]] std::vector<std::string> names_in(const std::filesystem::path& directory);
/// An entry of that day of January 2026 and hour.
[[nodiscard]] Entry entry_at(int day, int hour = 12, const std::string& members = R"("phase":"done")");

}  // namespace journal
