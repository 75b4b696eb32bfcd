#include "bridges/recorder/stored_records.h"

#include <algorithm>
#include <utility>

namespace recorder {

std::uint64_t StoredRecords::size() const noexcept {
  std::uint64_t size = 0;
  for (const StoredRecord& record : records_) {
    size += record.size();
  }
  return size;
}

void StoredRecords::add(StoredRecord record) {
  record.stem = to_text(record.name);
  remove(record.stem);
  const auto place = std::ranges::lower_bound(records_, record.stem, {}, &StoredRecord::stem);
  records_.insert(place, std::move(record));
}

void StoredRecords::remove(std::string_view stem) {
  if (const StoredRecord* const record = find(stem)) {
    records_.erase(records_.begin() + (record - records_.data()));
  }
}

const StoredRecord* StoredRecords::in_the_way(std::uint64_t more, std::uint64_t keep) const {
  const std::size_t count = records_.size() + (more > 0 ? 1U : 0U);
  if (records_.empty() || (size() + more <= keep && count <= kMost)) {
    return nullptr;
  }
  const auto usual = std::ranges::find_if(records_, [](const StoredRecord& record) { return !record.summary.first; });
  return usual == records_.end() ? &records_.front() : &*usual;
}

}  // namespace recorder
