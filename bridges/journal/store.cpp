#include "bridges/journal/store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "bridges/disk/own_directory.h"
#include "bridges/journal/tail.h"

namespace journal {
namespace {

// The oldest files go as a whole, so a file is a small part of all.
constexpr std::uint64_t kParts = 8;

}  // namespace

FileCalls FileCalls::real() {
  return {.write = [](int descriptor, const char* bytes, std::size_t size) { return ::write(descriptor, bytes, size); },
          .sync = [](int descriptor) { return fdatasync(descriptor); }};
}

Store::Store(std::filesystem::path directory, std::uint64_t limit, FileCalls calls)
    : directory_(std::move(directory)), limit_(limit), calls_(std::move(calls)) {}

Store::Failure Store::open(const Entry& now) {
  if (!lock_) {
    if (Failure failure = open_directory()) {
      return failure;
    }
  }
  if (!known_) {
    if (Failure failure = open_newest()) {
      return failure;
    }
  }
  if (file_ && was_taken_away()) {
    if (Failure failure = list_again()) {
      return failure;
    }
  }
  if (unended_) {
    if (Failure failure = end_line()) {
      return failure;
    }
  }
  return torn_ ? seal(now) : std::nullopt;
}

Store::Failure Store::append(const Entry& entry) {
  if (Failure failure = open(entry)) {
    return failure;
  }
  std::string line = make_line(entry, n_ + 1, hash_);
  if (Failure failure = rotate(entry, line.size() + 1)) {
    return failure;
  }
  return write_line(std::move(line));
}

Store::Failure Store::sync() {
  std::vector<disk::Descriptor> files;
  {
    const std::lock_guard lock(unsynced_);
    files = std::exchange(older_, {});
    if (std::exchange(written_, false)) {
      files.push_back(file_.duplicate());
    }
  }
  Failure failure;
  for (const disk::Descriptor& file : files) {
    if (calls_.sync(file.get()) != 0) {
      failure = fail("cannot bring lines to the disk");
    }
  }
  return failure;
}

Store::Failure Store::open_directory() {
  for (const std::filesystem::path& path : {directory_.parent_path(), directory_}) {
    if (mkdir(path.c_str(), 0750) != 0 && errno != EEXIST) {
      return fail("cannot make " + path.string());
    }
  }
  disk::OwnDirectory own = disk::take_directory(directory_);
  if (!own.lock) {
    return own.problem;
  }
  lock_ = std::move(own.lock);
  return std::nullopt;
}

Store::Failure Store::open_newest() {
  std::error_code failure;
  files_ = list_files(directory_, failure);
  // A crash between making a file and its first line leaves an empty one.
  while (!failure && !files_.empty() && files_.back().size == 0) {
    std::filesystem::remove(directory_ / to_string(files_.back().name), failure);
    files_.pop_back();
  }
  const Tail tail = failure ? Tail{} : find_tail(directory_, files_, failure);
  if (failure) {
    return "cannot read " + directory_.string() + ": " + failure.message();
  }
  if (!files_.empty()) {
    if (Failure wrong = open_file(files_.back().name)) {
      return wrong;
    }
    files_.back().size = tail.end;
    torn_ = tail.torn.bytes > 0;
    unended_ = tail.unended && !torn_;
  }
  n_ = tail.n;
  hash_ = tail.hash;
  known_ = true;
  return make_room(0);
}

Store::Failure Store::open_file(const FileName& name) {
  const std::filesystem::path path = directory_ / to_string(name);
  disk::Descriptor file(::open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0640));
  if (!file) {
    return fail("cannot open " + path.string());
  }
  const std::lock_guard lock(unsynced_);
  if (file_ && std::exchange(written_, false)) {
    older_.push_back(std::move(file_));
  }
  file_ = std::move(file);
  return std::nullopt;
}

Store::Failure Store::end_line() {
  if (Failure failure = write_all("\n")) {
    return failure;
  }
  ++files_.back().size;
  unended_ = false;
  return std::nullopt;
}

// What stands behind the last line was not written to its end. It is kept, and the line behind it, in the same file,
// tells what it is.
Store::Failure Store::seal(const Entry& now) {
  File& newest = files_.back();
  const std::filesystem::path path = directory_ / to_string(newest.name);
  std::uint64_t bytes = 0;
  Sha256 hash;
  char last_byte = '\n';
  const std::error_code failure = read_pieces(path, newest.size, [&](std::string_view piece) {
    hash.add(piece);
    bytes += piece.size();
    last_byte = piece.back();
  });
  if (failure) {
    return "cannot read " + path.string() + ": " + failure.message();
  }
  if (last_byte != '\n') {
    if (Failure wrong = write_all("\n")) {
      return wrong;
    }
    hash.add("\n");
    ++bytes;
  }
  torn_ = false;
  if (bytes == 0) {
    return std::nullopt;
  }
  const std::uint64_t end = newest.size;
  newest.size += bytes;
  const Entry torn{now.wall, now.at,
                   "\"phase\":\"torn\",\"bytes\":" + std::to_string(bytes) + ",\"sha256\":\"" + hash.finish() + "\""};
  Failure wrong = write_line(make_line(torn, n_ + 1, hash_));
  if (wrong) {
    files_.back().size = end;
    torn_ = true;
  }
  return wrong;
}

Store::Failure Store::write_line(std::string line) {
  std::string hash = sha256(line);
  line += '\n';
  if (Failure failure = make_room(line.size())) {
    return failure;
  }
  if (Failure failure = write_all(line)) {
    // A part of it may stand there. It is no evidence of a crash, and is taken away.
    torn_ = ftruncate(file_.get(), static_cast<off_t>(files_.back().size)) != 0;
    return failure;
  }
  {
    const std::lock_guard lock(unsynced_);
    written_ = true;
  }
  files_.back().size += line.size();
  ++n_;
  hash_ = std::move(hash);
  line_ = std::move(line);
  return std::nullopt;
}

// A clock that was put back does not lead back to older files.
Store::Failure Store::rotate(const Entry& entry, std::size_t size) {
  const auto day = std::chrono::floor<std::chrono::days>(entry.wall);
  const bool none = files_.empty() || !file_;
  FileName name{day, 1};
  if (!files_.empty() && files_.back().name.day >= day) {
    name = files_.back().name;
    const bool full = files_.back().size > 0 && files_.back().size + size > limit_ / kParts;
    name.part += full || none ? 1 : 0;
  }
  if (none || name != files_.back().name) {
    if (Failure failure = open_file(name)) {
      return failure;
    }
    files_.push_back({name, 0});
  }
  return std::nullopt;
}

Store::Failure Store::make_room(std::size_t size) {
  std::uint64_t all = size;
  for (const File& file : files_) {
    all += file.size;
  }
  while (all > limit_ && files_.size() > 1) {
    const std::filesystem::path path = directory_ / to_string(files_.front().name);
    if (unlink(path.c_str()) != 0 && errno != ENOENT) {
      return fail("cannot remove " + path.string());
    }
    all -= files_.front().size;
    files_.erase(files_.begin());
  }
  return std::nullopt;
}

Store::Failure Store::write_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t size = calls_.write(file_.get(), bytes.data(), bytes.size());
    if (size < 0 && errno == EINTR) {
      continue;
    }
    if (size <= 0) {
      return fail("cannot write " + (directory_ / to_string(files_.back().name)).string());
    }
    bytes.remove_prefix(static_cast<std::size_t>(size));
  }
  return std::nullopt;
}

// Somebody removed the newest file. The chain goes on from memory, so that `journal verify` finds what is missing.
Store::Failure Store::list_again() {
  {
    const std::lock_guard lock(unsynced_);
    file_.reset();
    written_ = false;
  }
  torn_ = false;
  unended_ = false;
  std::error_code failure;
  files_ = list_files(directory_, failure);
  return failure ? Failure("cannot read " + directory_.string() + ": " + failure.message()) : std::nullopt;
}

bool Store::was_taken_away() const {
  struct stat status{};
  return fstat(file_.get(), &status) == 0 && status.st_nlink == 0;
}

Store::Failure Store::fail(std::string_view what) const {
  return std::string(what) + ": " + std::generic_category().message(errno);
}

}  // namespace journal
