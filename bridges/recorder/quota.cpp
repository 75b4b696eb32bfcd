#include "bridges/recorder/quota.h"

#include <utility>

namespace recorder {

Quota::Verdict Quota::take(const std::string& subject, canopen::TimePoint now) {
  Subject& known = subjects_[subject];
  while (!known.begun.empty() && now - known.begun.front() >= kTime) {
    known.begun.pop_front();
  }
  if (known.begun.size() >= kMost) {
    return {.allowed = false, .first_refusal = known.refused++ == 0};
  }
  known.begun.push_back(now);
  return {.allowed = true, .refused_before = std::exchange(known.refused, 0)};
}

}  // namespace recorder
