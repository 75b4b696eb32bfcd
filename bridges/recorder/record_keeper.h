#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "bridges/disk/trouble.h"
#include "bridges/disk/worker.h"
#include "bridges/recorder/record.h"
#include "bridges/recorder/record_store.h"
#include "canopen/clock.h"
#include "canopen/event.h"
#include "canopen/wake_up.h"

namespace recorder {

/// Where records are kept.
struct KeptAt {
  std::filesystem::path state_directory;
  std::uint64_t keep = 200'000'000;  ///< Bytes, all records together.
  DiskCalls calls = DiskCalls::real();
};

/// Keeps finished records in files, written by a thread of its own: the loop never waits for the disk. One is written
/// at a time, one more of each bus waits. What the disk refuses is tried again for a minute.
class RecordKeeper {
 public:
  /// `told`: what a person should know: what does not work, and when it does again.
  RecordKeeper(const boost::asio::any_io_executor& executor, KeptAt at, disk::Trouble::Told told);

  struct Handlers {
    std::function<void(const Record& record)> kept;  ///< It is whole on the disk.
    std::function<void()> changed;                   ///< records() is another list.
  };
  /// Looks at what there is, and begins to write.
  void start(Handlers handlers);
  void post(Record record);
  /// Somebody found that a record is gone: looks at what there is, soon.
  void look();
  /// Returns when all is on the disk, at the latest after a second.
  boost::asio::awaitable<void> stop();

  /// As of the last look; nothing before the first, and while the directory cannot be used.
  [[nodiscard]] const std::optional<StoredRecords>& records() const noexcept { return records_; }
  /// A record of that name waits, or is on the disk.
  [[nodiscard]] bool knows(std::string_view stem) const;
  [[nodiscard]] std::filesystem::path directory() const { return directory_; }
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
  /// False where the last record could not be written, the directory cannot be used, or the disk does not answer.
  [[nodiscard]] bool works() const noexcept;
  /// Its thread is with the disk just now: to let the keeper go may wait for that.
  [[nodiscard]] bool is_busy() const noexcept { return worker_.busy(); }

  static constexpr canopen::Duration kTryAgain = std::chrono::seconds(5);
  static constexpr canopen::Duration kGiveUp = std::chrono::minutes(1);
  /// A write that takes longer is told.
  static constexpr canopen::Duration kSlow = std::chrono::seconds(5);

 private:
  struct Waiting {
    std::shared_ptr<const Record> record;  ///< With the job under way, which may outlive us.
    std::string stem;
    canopen::TimePoint since;
  };
  struct Written {
    Failure failure{};
    std::optional<StoredRecords> records{};  ///< Nothing: the directory is not ours.
  };

  void on_time();
  void tell_if_slow(canopen::TimePoint now);
  void begin(canopen::TimePoint now);
  void on_written(Written& written);
  void note_success(bool was_record);
  void note_failure(const std::string& why, bool was_record, canopen::TimePoint now);
  void give_up(std::deque<Waiting>::iterator record, const std::string& why);

  std::shared_ptr<RecordStore> store_;  ///< Likewise.
  std::filesystem::path directory_;
  disk::Trouble::Told told_;
  disk::Trouble trouble_;
  Handlers handlers_;
  canopen::WakeUp time_;
  canopen::Event progress_;
  disk::Worker worker_;
  std::deque<Waiting> waiting_;  ///< The first is under way where `writing_`.
  std::optional<StoredRecords> records_;
  std::optional<canopen::TimePoint> begun_;  ///< The job under way.
  std::optional<canopen::TimePoint> retry_;  ///< The last job failed: not before this.
  bool writing_ = false;
  bool look_ = false;  ///< At what there is, where nothing is to be written.
  bool stopping_ = false;
  /// A record could not be written where the directory could be used: that the directory can be looked at, which takes
  /// no room, does not end it.
  bool refuses_records_ = false;
  std::uint64_t lost_ = 0;
};

}  // namespace recorder
