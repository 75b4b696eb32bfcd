#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "bridges/alarms/alarm_memory.h"
#include "bridges/alarms/memory_file.h"
#include "bridges/disk/trouble.h"
#include "bridges/disk/worker.h"
#include "canopen/clock.h"
#include "canopen/event.h"
#include "canopen/wake_up.h"

namespace alarms {

/// Where alarms are kept.
struct KeptAt {
  std::filesystem::path directory;
  MemoryCalls calls = MemoryCalls::real();
  std::chrono::milliseconds load_patience{1000};  ///< How long the start waits for the disk.
};

/// Keeps the alarms in a file, written by a thread of its own: the loop never waits for the disk. One write is under
/// way at a time, and what comes meanwhile is in the next one. While the disk refuses it is tried again each second.
class AlarmKeeper {
 public:
  /// `told`: what a person should know: what does not work, and when it does again.
  AlarmKeeper(const boost::asio::any_io_executor& executor, const KeptAt& at, disk::Trouble::Told told);

  /// What was kept, before the loop runs; waits for the disk no longer than `load_patience`. A file that is none is set
  /// aside and told.
  [[nodiscard]] AlarmMemory load();

  /// From now on `snapshot` is what is to be kept; called on the loop.
  void start(std::function<AlarmMemory()> snapshot);
  /// A begin or an end: it is written at once, at most each kSpacing.
  void on_begin_or_end();
  /// Everything else is written at most each kPause.
  void on_change();
  /// Returns when all is on the disk, at the latest after a second.
  boost::asio::awaitable<void> stop();

  static constexpr canopen::Duration kSpacing = std::chrono::milliseconds(100);
  static constexpr canopen::Duration kPause = std::chrono::seconds(10);
  static constexpr canopen::Duration kTryAgain = std::chrono::seconds(1);
  /// A write that takes longer is told.
  static constexpr canopen::Duration kSlow = std::chrono::seconds(5);

 private:
  void want(canopen::TimePoint at);
  void on_time();
  void tell_if_slow(canopen::TimePoint now);
  void write(canopen::TimePoint now);
  void on_written(const MemoryFile::Failure& failure);

  std::shared_ptr<MemoryFile> file_;  ///< With the job under way, which may outlive us.
  std::filesystem::path directory_;
  std::chrono::milliseconds load_patience_;
  disk::Trouble::Told told_;
  disk::Trouble trouble_;
  disk::Worker worker_;
  canopen::WakeUp time_;
  canopen::Event progress_;
  std::function<AlarmMemory()> snapshot_;
  canopen::TimePoint due_ = canopen::kNever;  ///< Of the next write; never: nothing changed.
  std::optional<canopen::TimePoint> begun_;   ///< The last write.
  std::optional<canopen::TimePoint> retry_;   ///< The last write failed: not before this.
  bool stopping_ = false;
};

}  // namespace alarms
