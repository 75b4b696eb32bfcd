#include "bridges/disk/trouble.h"

namespace disk {

void Trouble::stands(const std::string& what, canopen::TimePoint now) {
  if (what == standing_ || now < next_) {
    return;
  }
  standing_ = what;
  next_ = now + std::chrono::minutes(1);
  told_(what);
}

void Trouble::is_over(const std::string& what) {
  if (!standing_.empty()) {
    standing_.clear();
    told_(what);
  }
}

}  // namespace disk
