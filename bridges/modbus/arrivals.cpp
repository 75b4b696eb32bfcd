#include "bridges/modbus/arrivals.h"

#include <algorithm>

namespace modbus {

void Arrivals::on_look(std::uint64_t position, canopen::TimePoint now) {
  add(position, {.earliest = looked_, .latest = now});
  looked_ = now;
}

void Arrivals::on_awaited(std::uint64_t position, canopen::TimePoint now) {
  add(position, {.earliest = now, .latest = now});
  looked_ = now;
}

void Arrivals::add(std::uint64_t end, Between came) {
  if (end <= end_) {
    return;
  }
  end_ = end;
  if (count_ == parts_.size()) {
    parts_[count_ - 1].end = end;
    parts_[count_ - 1].came.latest = came.latest;
    return;
  }
  parts_[count_++] = {.end = end, .came = came};
}

Arrivals::Between Arrivals::of(std::uint64_t position) const {
  const auto part = std::ranges::find_if(parts(), [position](const Part& each) { return each.end >= position; });
  return part == parts().end() ? Between{looked_, looked_} : part->came;
}

void Arrivals::forget(std::uint64_t position) {
  const auto begin = parts_.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(count_);
  const auto first = std::find_if(begin, end, [position](const Part& each) { return each.end > position; });
  count_ = static_cast<std::size_t>(std::move(first, end, begin) - begin);
}

}  // namespace modbus
