#include "bridges/alarms/memory_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "bridges/disk/own_directory.h"

namespace alarms {
namespace {

constexpr std::string_view kNewName = "alarms.json.new";

std::string failed(const std::string& what) {
  return what + ": " + std::generic_category().message(errno);
}

}  // namespace

MemoryCalls MemoryCalls::real() {
  return {.read = [](int descriptor, char* bytes, std::size_t size) { return ::read(descriptor, bytes, size); },
          .write = [](int descriptor, const char* bytes, std::size_t size) { return ::write(descriptor, bytes, size); },
          .sync = [](int descriptor) { return ::fsync(descriptor); },
          .rename = [](const char* from, const char* to) { return ::rename(from, to); }};
}

MemoryFile::MemoryFile(std::filesystem::path directory, MemoryCalls calls)
    : directory_(std::move(directory)), calls_(std::move(calls)) {}

MemoryFile::Failure MemoryFile::open() {
  if (lock_ && !disk::is_another_directory(lock_, directory_)) {
    return std::nullopt;
  }
  lock_.reset();
  if (mkdir(directory_.c_str(), 0750) != 0 && errno != EEXIST) {
    return failed("cannot make " + directory_.string());
  }
  disk::OwnDirectory own = disk::take_directory(directory_);
  if (!own.lock) {
    return own.problem;
  }
  lock_ = std::move(own.lock);
  return std::nullopt;
}

MemoryFile::Failure MemoryFile::read(std::optional<std::string>& text) {
  text.reset();
  const std::filesystem::path path = directory_ / kName;
  // A FIFO in its place must not keep us waiting.
  const disk::Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file) {
    return errno == ENOENT ? std::nullopt : Failure(failed("cannot open " + path.string()));
  }
  text.emplace();
  std::array<char, 65536> bytes{};
  for (;;) {
    const ssize_t size = calls_.read(file.get(), bytes.data(), bytes.size());
    if (size < 0 && errno == EINTR) {
      continue;
    }
    if (size < 0) {
      return failed("cannot read " + path.string());
    }
    if (size == 0) {
      return std::nullopt;
    }
    text->append(bytes.data(), static_cast<std::size_t>(size));
    if (text->size() > kMaxSize) {
      return path.string() + " is longer than any that a gateway writes";
    }
  }
}

MemoryFile::Failure MemoryFile::set_aside() {
  const std::filesystem::path from = directory_ / kName;
  const std::filesystem::path to = directory_ / kBadName;
  if (calls_.rename(from.c_str(), to.c_str()) != 0) {
    return failed("cannot rename it to " + to.string());
  }
  return std::nullopt;
}

MemoryFile::Failure MemoryFile::write(std::string_view text) {
  if (Failure failure = open()) {
    return failure;
  }
  const std::filesystem::path path = directory_ / kName;
  const std::filesystem::path fresh = directory_ / kNewName;
  if (Failure failure = write_new(fresh, text)) {
    unlink(fresh.c_str());  // On a full disk its room is wanted.
    return failure;
  }
  if (calls_.rename(fresh.c_str(), path.c_str()) != 0) {
    Failure failure = failed("cannot rename " + fresh.string());
    unlink(fresh.c_str());
    return failure;
  }
  // Without it the old name may be back after a power failure.
  return calls_.sync(lock_.get()) == 0 ? std::nullopt
                                       : Failure(failed("cannot bring " + path.string() + " to the disk"));
}

MemoryFile::Failure MemoryFile::write_new(const std::filesystem::path& path, std::string_view text) {
  const disk::Descriptor file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0640));
  if (!file) {
    return failed("cannot open " + path.string());
  }
  while (!text.empty()) {
    const ssize_t size = calls_.write(file.get(), text.data(), text.size());
    if (size < 0 && errno == EINTR) {
      continue;
    }
    if (size <= 0) {
      return failed("cannot write " + path.string());
    }
    text.remove_prefix(static_cast<std::size_t>(size));
  }
  return calls_.sync(file.get()) == 0 ? std::nullopt
                                      : Failure(failed("cannot bring " + path.string() + " to the disk"));
}

}  // namespace alarms
