// How a RecordStore makes room.
#include <algorithm>
#include <cerrno>
#include <string_view>

#include "bridges/recorder/record_store.h"

namespace recorder {

// Of a log it is known by its frames, of a JSON about.
std::uint64_t RecordStore::most_bytes(const Record& record) const {
  constexpr std::uint64_t kLine = 50;  // without the interface
  constexpr std::uint64_t kHead = 4096;
  constexpr std::uint64_t kAlarm = 2048;
  std::uint64_t frames = 0;
  for (const FrameSlice::Piece& piece : record.frames.pieces) {
    frames += piece.count;
  }
  std::uint64_t size = std::min(share_of_log(), frames * (kLine + record.interface.size())) + kHead;
  for (const std::string& command : record.commands) {
    size += command.size();
  }
  return size + record.alarms.size() * kAlarm;
}

Failure RecordStore::make_space(std::uint64_t bytes) {
  const auto space = calls_.space(lock_.get());
  const std::uint64_t wanted = space ? bytes + std::min(kReserve, space->all / 10) : 0;
  if (!space || space->left >= wanted) {
    return std::nullopt;
  }
  const std::uint64_t missing = wanted - space->left;
  if (records_.size() < missing) {
    return "the file system of " + directory_.string() + " is full, but for what is left to the journal and the alarms";
  }
  return remove_bytes(missing);
}

Failure RecordStore::remove_bytes(std::uint64_t bytes) {
  for (std::uint64_t removed = 0; removed < bytes;) {
    const StoredRecord* const old = records_.in_the_way(0, 0);
    if (old == nullptr) {
      break;
    }
    const std::uint64_t size = old->size();
    if (Failure failure = remove(std::string(old->stem))) {
      return failure;
    }
    removed += size;
  }
  return std::nullopt;
}

Failure RecordStore::make_room(std::uint64_t more) {
  while (const StoredRecord* const old = records_.in_the_way(more, keep_)) {
    if (Failure failure = remove(std::string(old->stem))) {
      return failure;
    }
  }
  return std::nullopt;
}

// The log goes last: as long as it is there it is found again, and counted.
Failure RecordStore::remove(const std::string& stem) {
  for (const std::string_view suffix : {kJsonSuffix, kLogSuffix}) {
    if (calls_.remove(lock_.get(), (stem + std::string(suffix)).c_str()) != 0 && errno != ENOENT) {
      return failed("cannot remove an old record in " + directory_.string());
    }
  }
  records_.remove(stem);
  return std::nullopt;
}

}  // namespace recorder
