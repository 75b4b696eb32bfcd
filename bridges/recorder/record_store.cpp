#include "bridges/recorder/record_store.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <utility>
#include <vector>

#include "bridges/disk/own_directory.h"
#include "bridges/recorder/candump.h"

namespace recorder {
namespace {

Failure make_directory(const std::filesystem::path& path) {
  return mkdir(path.c_str(), 0750) == 0 || errno == EEXIST ? std::nullopt
                                                           : Failure(failed("cannot make " + path.string()));
}

std::optional<std::uint64_t> size_of(int directory, const std::string& name) {
  struct stat facts{};
  const bool found = fstatat(directory, name.c_str(), &facts, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(facts.st_mode);
  return found ? std::optional(static_cast<std::uint64_t>(facts.st_size)) : std::nullopt;
}

Failure write_all(std::string_view text, WholeFile& file) {
  if (Failure failure = file.open()) {
    return failure;
  }
  Failure failure = file.append(text);
  return failure ? failure : file.sync();
}

bool is_leftover(std::string_view file) {
  if (!file.ends_with(kNewSuffix)) {
    return false;
  }
  file.remove_suffix(kNewSuffix.size());
  const std::string_view suffix = file.ends_with(kLogSuffix) ? kLogSuffix : kJsonSuffix;
  return file.ends_with(suffix) && parse_record_name(file.substr(0, file.size() - suffix.size()));
}

std::vector<std::string> files_in(int directory, Failure& failure) {
  std::vector<std::string> files;
  const int again = openat(directory, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const std::unique_ptr<DIR, int (*)(DIR*)> opened(again < 0 ? nullptr : fdopendir(again), closedir);
  if (!opened) {
    failure = failed("cannot list the records");
    return files;
  }
  while (const dirent* const entry = readdir(opened.get())) {  // NOLINT(concurrency-mt-unsafe): a stream of its own
    files.emplace_back(&entry->d_name[0]);
  }
  return files;
}

}  // namespace

RecordStore::RecordStore(std::filesystem::path state_directory, std::uint64_t keep, DiskCalls calls)
    : state_directory_(std::move(state_directory)),
      directory_(state_directory_ / kDirectory),
      keep_(keep),
      calls_(std::move(calls)) {}

Failure RecordStore::open() {
  Failure failure = use_directory();
  return failure ? failure : make_room(0);
}

Failure RecordStore::use_directory() {
  if (!lock_ || disk::is_another_directory(lock_, directory_)) {
    lock_.reset();
    records_ = {};
    if (Failure failure = take_directory()) {
      return failure;
    }
  }
  Failure failure = look();
  if (failure) {
    lock_.reset();
  }
  return failure;
}

Failure RecordStore::take_directory() {
  for (const std::filesystem::path& path : {state_directory_, directory_}) {
    if (Failure failure = make_directory(path)) {
      return failure;
    }
  }
  disk::OwnDirectory own = disk::take_directory(directory_);
  if (!own.lock) {
    return own.problem;
  }
  lock_ = std::move(own.lock);
  return std::nullopt;
}

// Somebody may have removed some of them, to gain room, say: before each record it is seen what there is.
Failure RecordStore::look() {
  Failure failure;
  const std::vector<std::string> files = files_in(lock_.get(), failure);
  if (failure) {
    return failure;
  }
  const StoredRecords before = std::exchange(records_, {});
  for (const std::string& file : files) {
    if (is_leftover(file)) {
      unlinkat(lock_.get(), file.c_str(), 0);
    } else if (file.ends_with(kLogSuffix)) {
      look_at(file, before);
    } else if (file.ends_with(kJsonSuffix)) {
      remove_lonely(file);
    }
  }
  return std::nullopt;
}

void RecordStore::look_at(const std::string& file, const StoredRecords& before) {
  const std::string stem = file.substr(0, file.size() - kLogSuffix.size());
  const auto name = parse_record_name(stem);
  const auto log_size = size_of(lock_.get(), file);
  if (!name || !log_size) {
    return;
  }
  StoredRecord record{.name = *name, .log_size = *log_size};
  const std::string json_name = stem + std::string(kJsonSuffix);
  if (const auto json_size = size_of(lock_.get(), json_name)) {
    record.json_size = *json_size;
    const StoredRecord* const known = before.find(stem);
    record.summary = known != nullptr && known->json_size == *json_size
                         ? known->summary
                         : parse_summary(read_json(json_name)).value_or(RecordSummary{});
  }
  records_.add(std::move(record));
}

// Who removed the log removed the record; nobody would find the rest of it again.
void RecordStore::remove_lonely(const std::string& json) const {
  const std::string stem = json.substr(0, json.size() - kJsonSuffix.size());
  struct stat facts{};
  const bool has_no_log =
      fstatat(lock_.get(), (stem + std::string(kLogSuffix)).c_str(), &facts, AT_SYMLINK_NOFOLLOW) != 0 &&
      errno == ENOENT;
  if (has_no_log && parse_record_name(stem) && size_of(lock_.get(), json) && parse_summary(read_json(json))) {
    unlinkat(lock_.get(), json.c_str(), 0);
  }
}

std::string RecordStore::read_json(const std::string& name) const {
  std::string text;
  const disk::Descriptor file(openat(lock_.get(), name.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  std::vector<char> piece(65536);
  while (file && text.size() <= kLongestJson) {
    const ssize_t size = read(file.get(), piece.data(), piece.size());
    if (size < 0 && errno == EINTR) {
      continue;
    }
    if (size <= 0) {
      break;
    }
    text.append(piece.data(), static_cast<std::size_t>(size));
  }
  return text;
}

Failure RecordStore::write(const Record& record) {
  if (Failure failure = use_directory()) {
    return failure;
  }
  const std::uint64_t most = most_bytes(record);
  if (Failure failure = make_space(most)) {
    return failure;
  }
  bool full = false;
  Failure failure = write_files(record, full);
  const std::string stem = to_text(record.name);
  // A quota, say, of which the file system tells nothing. Once for a record: where others fill the disk it is of no use
  // that one record after another goes.
  if (full && room_made_for_ != stem && !records_.all().empty()) {
    room_made_for_ = stem;
    Failure kept = remove_bytes(most);
    failure = kept ? kept : write_files(record, full);
  }
  return failure;
}

Failure RecordStore::write_files(const Record& record, bool& full) {
  const std::string stem = to_text(record.name);
  WholeFile log(lock_.get(), stem + std::string(kLogSuffix), calls_);
  WholeFile beside(lock_.get(), stem + std::string(kJsonSuffix), calls_);
  LogFigures figures;
  Failure failure = write_log(record, log, figures);
  if (!failure) {
    failure = write_all(record_json(record, figures), beside);
  }
  if (!failure) {
    failure = name_files(record, figures, log, beside);
  }
  full = log.met_full_disk() || beside.met_full_disk();
  return failure;
}

Failure RecordStore::name_files(const Record& record, const LogFigures& figures, WholeFile& log, WholeFile& beside) {
  // A JSON never stands alone: who removes one later has the log to find it by.
  if (Failure failure = log.name()) {
    return failure;
  }
  if (Failure failure = beside.name()) {
    unlinkat(lock_.get(), (to_text(record.name) + std::string(kLogSuffix)).c_str(), 0);
    return failure;
  }
  Failure failure;
  if (calls_.sync(lock_.get()) != 0) {
    failure = failed("cannot bring the names in " + directory_.string() + " to the disk");
  }
  // Only now, since a new one that did not come to be is no reason for an old one to go. One that cannot be removed
  // stays listed, and is no reason to lose the new one.
  records_.remove(to_text(record.name));
  static_cast<void>(make_room(log.size() + beside.size()));
  records_.add({.name = record.name,
                .log_size = log.size(),
                .json_size = beside.size(),
                .summary = {record.bus, record.drive, record.first(), figures.frames, record.commands.size()}});
  return failure;
}

Failure RecordStore::write_log(const Record& record, WholeFile& file, LogFigures& figures) const {
  Failure failure = file.open();
  std::string line;
  record.frames.each([&](const KeptFrame& frame) {
    if (failure || figures.shortened) {
      return;
    }
    if (frame.kind == KeptFrame::Kind::gap) {
      figures.lost += frame.id;
      if (figures.gaps.size() < LogFigures::kMostGaps) {
        figures.gaps.push_back({frame.wall, frame.id});
      }
      return;
    }
    line.clear();
    append_candump(line, record.interface, frame);
    if (file.size() + line.size() > share_of_log()) {
      figures.shortened = true;
      return;
    }
    ++figures.frames;
    figures.error_frames += frame.kind == KeptFrame::Kind::error ? 1 : 0;
    failure = file.append(line);
  });
  return failure ? failure : file.sync();
}

}  // namespace recorder
