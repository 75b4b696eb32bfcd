#include "bridges/recorder/record_store.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <utility>
#include <vector>

#include "bridges/recorder/candump.h"

namespace recorder {
namespace {

// Beside the log there is room for its JSON.
constexpr std::uint64_t share_of_log(std::uint64_t keep) {
  return keep / 2;
}

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
  if (lock_ && !is_another_directory()) {
    return std::nullopt;
  }
  lock_.reset();
  records_ = {};
  for (const std::filesystem::path& path : {state_directory_, directory_}) {
    if (Failure failure = make_directory(path)) {
      return failure;
    }
  }
  disk::Descriptor directory(::open(directory_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!directory) {
    return failed("cannot open " + directory_.string());
  }
  if (flock(directory.get(), LOCK_EX | LOCK_NB) != 0) {
    return errno == EWOULDBLOCK ? directory_.string() + " is in use by another process"
                                : failed("cannot lock " + directory_.string());
  }
  lock_ = std::move(directory);
  Failure failure = look();
  if (failure) {
    lock_.reset();
  }
  return failure;
}

// Somebody moved or removed it: what is locked is not what the path names.
bool RecordStore::is_another_directory() const {
  struct stat locked{};
  struct stat named{};
  return fstat(lock_.get(), &locked) != 0 || stat(directory_.c_str(), &named) != 0 || locked.st_dev != named.st_dev ||
         locked.st_ino != named.st_ino;
}

Failure RecordStore::look() {
  Failure failure;
  for (const std::string& file : files_in(lock_.get(), failure)) {
    if (is_leftover(file)) {
      unlinkat(lock_.get(), file.c_str(), 0);
    } else if (file.ends_with(kLogSuffix)) {
      look_at(file);
    }
  }
  return failure;
}

void RecordStore::look_at(const std::string& file) {
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
    record.summary = parse_summary(read_json(json_name)).value_or(RecordSummary{});
  }
  records_.add(std::move(record));
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
  if (Failure failure = open()) {
    return failure;
  }
  const std::string stem = to_text(record.name);
  WholeFile log(lock_.get(), stem + std::string(kLogSuffix), calls_);
  WholeFile beside(lock_.get(), stem + std::string(kJsonSuffix), calls_);
  LogFigures figures;
  if (Failure failure = write_log(record, log, figures)) {
    return failure;
  }
  if (Failure failure = write_all(record_json(record, figures), beside)) {
    return failure;
  }
  make_room(log.size() + beside.size());
  // A JSON never stands alone: who removes one later has the log to find it by.
  if (Failure failure = log.name()) {
    return failure;
  }
  if (Failure failure = beside.name()) {
    unlinkat(lock_.get(), (stem + std::string(kLogSuffix)).c_str(), 0);
    return failure;
  }
  records_.add({.name = record.name,
                .log_size = log.size(),
                .json_size = beside.size(),
                .summary = {record.bus, record.drive, record.first(), figures.frames, record.commands.size()}});
  return calls_.sync(lock_.get()) == 0
             ? std::nullopt
             : Failure(failed("cannot bring the names in " + directory_.string() + " to the disk"));
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
    if (file.size() + line.size() > share_of_log(keep_)) {
      figures.shortened = true;
      return;
    }
    ++figures.frames;
    figures.error_frames += frame.kind == KeptFrame::Kind::error ? 1 : 0;
    failure = file.append(line);
  });
  return failure ? failure : file.sync();
}

void RecordStore::make_room(std::uint64_t more) {
  while (const StoredRecord* const old = records_.in_the_way(more, keep_)) {
    const std::string stem = old->stem;
    // The log goes last: as long as it is there it is found again, and counted.
    unlinkat(lock_.get(), (stem + std::string(kJsonSuffix)).c_str(), 0);
    unlinkat(lock_.get(), (stem + std::string(kLogSuffix)).c_str(), 0);
    records_.remove(stem);
  }
}

}  // namespace recorder
