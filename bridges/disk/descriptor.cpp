#include "bridges/disk/descriptor.h"

#include <fcntl.h>
#include <unistd.h>

namespace disk {

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) {
    reset();
    number_ = std::exchange(other.number_, -1);
  }
  return *this;
}

Descriptor Descriptor::duplicate() const noexcept {
  return Descriptor(number_ < 0 ? -1 : fcntl(number_, F_DUPFD_CLOEXEC, 0));
}

void Descriptor::reset() noexcept {
  if (number_ >= 0) {
    close(number_);
  }
  number_ = -1;
}

}  // namespace disk
