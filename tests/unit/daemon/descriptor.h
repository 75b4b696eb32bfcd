#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace gateway::test {

/// An open file, closed with it.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  Descriptor(Descriptor&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~Descriptor() { close(); }

  void close() {
    if (descriptor_ >= 0) {
      ::close(std::exchange(descriptor_, -1));
    }
  }
  [[nodiscard]] int get() const noexcept { return descriptor_; }

 private:
  int descriptor_ = -1;
};

/// What JOURNAL_STREAM holds where this file is the journal: its device and inode (systemd.exec(5)).
[[nodiscard]] inline std::string as_journal(int descriptor) {
  struct stat status{};
  if (::fstat(descriptor, &status) != 0) {
    throw std::runtime_error("no such descriptor");
  }
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
}

struct Pipe {
  Descriptor out;  ///< Is read from.
  Descriptor in;   ///< Is written to.
};

[[nodiscard]] inline Pipe make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) {
    throw std::runtime_error("no pipe");
  }
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

/// One of the standard descriptors stands for another file while this lives.
class Redirected {
 public:
  Redirected(int standard, const Descriptor& instead) : standard_(standard), before_(::dup(standard)) {
    ::dup2(instead.get(), standard_);
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;
  ~Redirected() {
    if (before_.get() >= 0) {
      ::dup2(before_.get(), standard_);
    } else {
      ::close(standard_);
    }
  }

 private:
  int standard_;
  Descriptor before_;
};

}  // namespace gateway::test
