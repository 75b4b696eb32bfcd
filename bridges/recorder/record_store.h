#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "bridges/disk/descriptor.h"
#include "bridges/recorder/record.h"
#include "bridges/recorder/record_text.h"
#include "bridges/recorder/stored_records.h"
#include "bridges/recorder/whole_file.h"

namespace recorder {

/// `records/` in a state directory, as the one process that uses it sees it: for each record a log and a JSON. Files of
/// other names are left alone. Every call may wait for the disk.
class RecordStore {
 public:
  /// `keep`: bytes that all records together may take.
  RecordStore(std::filesystem::path state_directory, std::uint64_t keep, DiskCalls calls);

  static constexpr std::string_view kDirectory = "records";
  /// No JSON of ours is longer.
  static constexpr std::size_t kLongestJson = 8UL * 1024 * 1024;

  /// So much of the file system is left to others, alarms and journal: 16 MB, of a small one a tenth.
  static constexpr std::uint64_t kReserve = 16'000'000;

  /// Takes the directory for this process, makes it where it is not there, and looks at what there is: removes what a
  /// crash left half written, and a JSON whose log somebody removed. What is too much for `keep` goes.
  [[nodiscard]] Failure open();
  /// Looks, as open() does, then writes both files: after a crash at any moment neither is there by its name, or the
  /// log, or both. Where the file system is too full for them older records go before, where that is enough; those that
  /// are in the way of `keep` go when the new one is there.
  [[nodiscard]] Failure write(const Record& record);

  /// The directory is ours, and was looked at.
  [[nodiscard]] bool is_open() const noexcept { return static_cast<bool>(lock_); }
  [[nodiscard]] const StoredRecords& records() const noexcept { return records_; }
  [[nodiscard]] const std::filesystem::path& directory() const noexcept { return directory_; }

 private:
  /// open(), but for what is too much.
  [[nodiscard]] Failure use_directory();
  [[nodiscard]] Failure take_directory();
  [[nodiscard]] Failure look();
  void look_at(const std::string& file, const StoredRecords& before);
  void remove_lonely(const std::string& json) const;
  [[nodiscard]] std::string read_json(const std::string& name) const;
  [[nodiscard]] Failure write_log(const Record& record, WholeFile& file, LogFigures& figures) const;
  /// `full`: it failed for want of room.
  [[nodiscard]] Failure write_files(const Record& record, bool& full);
  [[nodiscard]] Failure name_files(const Record& record, const LogFigures& figures, WholeFile& log, WholeFile& beside);
  /// Beside a log there is room for its JSON.
  [[nodiscard]] std::uint64_t share_of_log() const noexcept { return keep_ / 2; }
  /// What both files take at most.
  [[nodiscard]] std::uint64_t most_bytes(const Record& record) const;
  /// Removes older ones, so that `bytes` and the reserve find room in the file system.
  [[nodiscard]] Failure make_space(std::uint64_t bytes);
  /// So many bytes of older ones, in the order in which they go.
  [[nodiscard]] Failure remove_bytes(std::uint64_t bytes);
  /// What is in the way of `more` within `keep`.
  [[nodiscard]] Failure make_room(std::uint64_t more);
  [[nodiscard]] Failure remove(const std::string& stem);

  std::filesystem::path state_directory_;
  std::filesystem::path directory_;
  std::uint64_t keep_;
  DiskCalls calls_;
  disk::Descriptor lock_;  ///< Of the directory.
  StoredRecords records_;
  std::string room_made_for_;  ///< The record for which others went though the file system told of room.
};

}  // namespace recorder
