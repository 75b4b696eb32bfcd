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

  /// Takes the directory for this process, makes it where it is not there, removes what a crash left half written, and
  /// looks at what there is. Again where somebody exchanged or removed it.
  [[nodiscard]] Failure open();
  /// open(), then both files: after a crash at any moment neither is there by its name, or the log, or both. What is in
  /// the way of `keep` goes before.
  [[nodiscard]] Failure write(const Record& record);

  /// The directory is ours, and was looked at.
  [[nodiscard]] bool is_open() const noexcept { return static_cast<bool>(lock_); }
  [[nodiscard]] const StoredRecords& records() const noexcept { return records_; }
  [[nodiscard]] const std::filesystem::path& directory() const noexcept { return directory_; }

 private:
  [[nodiscard]] bool is_another_directory() const;
  [[nodiscard]] Failure look();
  void look_at(const std::string& file);
  [[nodiscard]] std::string read_json(const std::string& name) const;
  [[nodiscard]] Failure write_log(const Record& record, WholeFile& file, LogFigures& figures) const;
  void make_room(std::uint64_t more);

  std::filesystem::path state_directory_;
  std::filesystem::path directory_;
  std::uint64_t keep_;
  DiskCalls calls_;
  disk::Descriptor lock_;  ///< Of the directory.
  StoredRecords records_;
};

}  // namespace recorder
