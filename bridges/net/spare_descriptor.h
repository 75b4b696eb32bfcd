#pragma once

#include <fcntl.h>
#include <unistd.h>

namespace net {

/// One descriptor in reserve. Where no other is left it makes room for a connection that is waiting, so that nobody is
/// left in the system's queue: what he sent there would be carried out long after he gave up.
class SpareDescriptor {
 public:
  SpareDescriptor() { keep(); }
  ~SpareDescriptor() { release(); }
  SpareDescriptor(const SpareDescriptor&) = delete;
  SpareDescriptor& operator=(const SpareDescriptor&) = delete;

  /// False: no descriptor is free for it.
  bool keep() {
    if (descriptor_ < 0) {
      descriptor_ = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    }
    return descriptor_ >= 0;
  }
  /// False: it had gone already.
  bool release() {
    const bool kept = descriptor_ >= 0;
    if (kept) {
      ::close(descriptor_);
    }
    descriptor_ = -1;
    return kept;
  }

 private:
  int descriptor_ = -1;
};

}  // namespace net
