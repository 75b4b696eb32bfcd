#include "bridges/recorder/whole_file.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "bridges/recorder/record_name.h"

namespace recorder {
namespace {

constexpr std::size_t kPiece = 64UL * 1024;

std::optional<DiskCalls::Space> space_of(int directory) {
  struct statvfs facts{};
  return fstatvfs(directory, &facts) == 0 ? std::optional(DiskCalls::Space{.all = facts.f_blocks * facts.f_frsize,
                                                                           .left = facts.f_bavail * facts.f_frsize})
                                          : std::nullopt;
}

}  // namespace

std::string failed(const std::string& what) {
  return what + ": " + std::generic_category().message(errno);
}

DiskCalls DiskCalls::real() {
  return {.write = [](int descriptor, const char* bytes, std::size_t size) { return ::write(descriptor, bytes, size); },
          .sync = [](int descriptor) { return ::fsync(descriptor); },
          .rename = [](int directory, const char* from,
                       const char* to) { return ::renameat(directory, from, directory, to); },
          .remove = [](int directory, const char* name) { return ::unlinkat(directory, name, 0); },
          .space = space_of};
}

WholeFile::WholeFile(int directory, std::string name, const DiskCalls& calls)
    : directory_(directory), name_(std::move(name)), new_name_(name_ + std::string(kNewSuffix)), calls_(calls) {}

WholeFile::~WholeFile() {
  if (file_ && !named_) {
    unlinkat(directory_, new_name_.c_str(), 0);  // On a full disk its room is wanted.
  }
}

Failure WholeFile::fail(const std::string& what) {
  met_full_disk_ = errno == ENOSPC || errno == EDQUOT;
  return failed(what);
}

Failure WholeFile::open() {
  // What lies there is a leftover, or was put there: it is not written into.
  if (unlinkat(directory_, new_name_.c_str(), 0) != 0 && errno != ENOENT) {
    return failed("cannot remove what is left of a record");
  }
  file_ = disk::Descriptor(
      openat(directory_, new_name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0640));
  return file_ ? std::nullopt : fail("cannot make the file of a record");
}

Failure WholeFile::append(std::string_view text) {
  waiting_ += text;
  size_ += text.size();
  return waiting_.size() < kPiece ? std::nullopt : flush();
}

Failure WholeFile::flush() {
  std::string_view text = waiting_;
  while (!text.empty()) {
    const ssize_t size = calls_.write(file_.get(), text.data(), text.size());
    if (size < 0 && errno == EINTR) {
      continue;
    }
    if (size <= 0) {
      return fail("cannot write a record");
    }
    text.remove_prefix(static_cast<std::size_t>(size));
  }
  waiting_.clear();
  return std::nullopt;
}

Failure WholeFile::sync() {
  if (Failure failure = flush()) {
    return failure;
  }
  return calls_.sync(file_.get()) == 0 ? std::nullopt : fail("cannot bring a record to the disk");
}

Failure WholeFile::name() {
  if (calls_.rename(directory_, new_name_.c_str(), name_.c_str()) != 0) {
    return fail("cannot rename the file of a record");
  }
  named_ = true;
  return std::nullopt;
}

}  // namespace recorder
