#include "bridges/disk/own_directory.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace disk {
namespace {

OwnDirectory refused(const std::string& what) {
  return {.problem = what + ": " + std::generic_category().message(errno)};
}

}  // namespace

OwnDirectory take_directory(const std::filesystem::path& path) {
  Descriptor directory(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!directory) {
    return refused("cannot open " + path.string());
  }
  if (flock(directory.get(), LOCK_EX | LOCK_NB) != 0) {
    return errno == EWOULDBLOCK ? OwnDirectory{.problem = path.string() + " is in use by another process"}
                                : refused("cannot lock " + path.string());
  }
  return {.lock = std::move(directory)};
}

bool is_another_directory(const Descriptor& lock, const std::filesystem::path& path) {
  struct stat locked{};
  struct stat named{};
  return fstat(lock.get(), &locked) != 0 || stat(path.c_str(), &named) != 0 || locked.st_dev != named.st_dev ||
         locked.st_ino != named.st_ino;
}

}  // namespace disk
