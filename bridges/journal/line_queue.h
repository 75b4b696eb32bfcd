#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "bridges/disk/trouble.h"
#include "bridges/disk/worker.h"
#include "bridges/journal/line.h"
#include "bridges/journal/newest_lines.h"
#include "bridges/journal/store.h"
#include "canopen/clock.h"
#include "canopen/event.h"
#include "canopen/wake_up.h"

namespace journal {

/// Where a journal is kept.
struct Place {
  std::filesystem::path directory;
  std::uint64_t limit = 50'000'000;         ///< Bytes of all files together.
  std::size_t waiting = 4UL * 1024 * 1024;  ///< Bytes of lines that wait for a disk that hangs or is full.
  FileCalls calls = FileCalls::real();
};

/// Lines on their way to the disk, in order. A thread writes them, another one syncs what was written each second.
/// While the disk refuses, the first is tried again each second.
class LineQueue {
 public:
  LineQueue(const boost::asio::any_io_executor& executor, const Place& place, disk::Trouble::Told told);

  /// Looks how the chain goes on, and tells where there is none to go on with.
  void start();
  /// Its number; numbers grow by one. Where too much waits it is counted as lost, which a line tells in its place.
  std::uint64_t post(Entry entry);
  /// Returns when the line was given to the system, when that does not work, and in any case when the disk keeps lines
  /// waiting for kPatience; then it is told.
  boost::asio::awaitable<void> written(std::uint64_t number);
  /// Returns when all is on the disk, at the latest at `until`.
  boost::asio::awaitable<void> until_synced(canopen::TimePoint until);

  [[nodiscard]] const std::string& newest_hash() const noexcept { return newest_hash_; }
  /// What stands on the disk last.
  [[nodiscard]] const NewestLines& newest_lines() const noexcept { return newest_lines_; }
  /// Lines whose command did not wait for them any more.
  [[nodiscard]] std::uint64_t passed_by() const noexcept { return passed_by_; }
  /// Lines that were never written.
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

  static constexpr canopen::Duration kPatience = std::chrono::milliseconds(50);

 private:
  struct Waiting {
    Entry entry;
    std::uint64_t number = 0;  ///< 0: of a line about lost ones.
    canopen::TimePoint since;
  };
  struct Batch;

  void push(Entry entry, std::uint64_t number);
  void tell_lost();
  void write_next();
  void on_written(Batch& batch);
  void sync();
  void on_tick();
  [[nodiscard]] std::string summary() const;

  std::filesystem::path directory_;
  std::size_t most_waiting_;
  disk::Trouble trouble_;
  std::shared_ptr<Store> store_;  ///< With the job under way, which may outlive us.
  disk::Worker writer_;
  disk::Worker syncer_;
  canopen::Event progress_;
  canopen::WakeUp tick_;
  std::deque<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::uint64_t posted_ = 0;
  std::uint64_t done_ = 0;  ///< Number of the newest line written.
  std::uint64_t passed_by_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t lost_untold_ = 0;  ///< Of these: not told by a line yet.
  bool refused_ = false;           ///< The last attempt failed.
  bool unsynced_ = false;
  std::string newest_hash_;
  NewestLines newest_lines_;
};

}  // namespace journal
