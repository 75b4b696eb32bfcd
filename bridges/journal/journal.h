#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <deque>
#include <set>
#include <string>

#include "bridges/disk/trouble.h"
#include "bridges/journal/line_queue.h"
#include "bridges/journal/repeats.h"
#include "bridges/process/command.h"
#include "bridges/process/command_journal.h"
#include "canopen/wake_up.h"

namespace journal {

/// The commands, refused ones included, as a chain of lines on disk: docs/JOURNAL.md. Whatever becomes of the disk, no
/// command waits for it longer than LineQueue::kPatience, and none is refused.
class Journal final : public process::CommandJournal {
 public:
  /// `told`: what a person should know of the journal itself.
  Journal(const boost::asio::any_io_executor& executor, const Place& place, disk::Trouble::Told told);

  void start() { queue_.start(); }
  /// Writes what was only counted, and waits for the disk for at most a second.
  boost::asio::awaitable<void> stop();

  boost::asio::awaitable<void> begun(const process::CommandRecord& record) override;
  void done(const process::CommandRecord& record, const process::Outcome& outcome) override;

  /// SHA-256 of the newest line on disk, in hexadecimal; of the first line's `prev` where there is none yet; empty
  /// where the journal cannot be read.
  [[nodiscard]] const std::string& newest_hash() const noexcept { return queue_.newest_hash(); }
  /// The newest lines on the disk, oldest first.
  [[nodiscard]] const std::deque<std::string>& newest_lines() const noexcept { return queue_.newest_lines().lines(); }
  [[nodiscard]] LineQueue& queue() noexcept { return queue_; }

 private:
  void on_minute();

  LineQueue queue_;
  Repeats repeats_;
  std::multiset<std::string> begun_;  ///< Commands with a line `begun` and none `done`: who and id, which may repeat.
  canopen::WakeUp minute_;
};

}  // namespace journal
