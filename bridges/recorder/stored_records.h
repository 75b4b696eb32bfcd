#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/recorder/record_name.h"
#include "bridges/recorder/record_text.h"

namespace recorder {

/// A record on the disk.
struct StoredRecord {
  RecordName name;
  std::uint64_t log_size = 0;   ///< Bytes.
  std::uint64_t json_size = 0;  ///< Bytes; 0: there is no JSON beside the log.
  RecordSummary summary{};
  std::string stem{};  ///< to_text(name), which StoredRecords makes once: the loop looks for it often.

  [[nodiscard]] std::uint64_t size() const noexcept { return log_size + json_size; }
};

/// All records on the disk, oldest first.
class StoredRecords {
 public:
  /// However small they are.
  static constexpr std::size_t kMost = 1000;

  [[nodiscard]] const std::vector<StoredRecord>& all() const noexcept { return records_; }
  [[nodiscard]] std::uint64_t size() const noexcept;
  /// Replaces one of the same name.
  void add(StoredRecord record);
  void remove(std::string_view stem);
  /// Null: there is none of that name. Eleven comparisons of a thousand records.
  template <class Stem>
  [[nodiscard]] const StoredRecord* find(const Stem& stem) const {
    const auto place = std::lower_bound(records_.begin(), records_.end(), stem,
                                        [](const StoredRecord& record, const Stem& to) { return record.stem < to; });
    return place != records_.end() && place->stem == stem ? &*place : nullptr;
  }
  /// The next one that has to go so that one more of `more` bytes finds room within `keep` bytes: the oldest, and those
  /// with a fault that came first after all others; with 0 bytes those that there are. Null: there is room, or nothing
  /// is left.
  [[nodiscard]] const StoredRecord* in_the_way(std::uint64_t more, std::uint64_t keep) const;

 private:
  std::vector<StoredRecord> records_;
};

}  // namespace recorder
