#include "bridges/disk/trouble.h"

namespace disk {

void Trouble::stands(const std::string& what, canopen::TimePoint now) {
  std::erase_if(when_, [now](const auto& told) { return now >= told.second + std::chrono::minutes(1); });
  if (what == standing_ || when_.contains(what)) {
    return;
  }
  standing_ = what;
  when_.emplace(what, now);
  told_(what);
}

void Trouble::is_over(const std::string& what) {
  if (!standing_.empty()) {
    standing_.clear();
    told_(what);
  }
}

}  // namespace disk
