#include "canopen/sdo/late_answers.h"

#include <algorithm>

namespace canopen {
namespace {

// An answer that has not come after that many times the timeout will not come any more.
constexpr int kLateTimeouts = 4;

// One is enough, but it may be the very object that went unanswered.
constexpr std::size_t kReadableKept = 4;

}  // namespace

void LateAnswers::note_unanswered(ObjectAddress object, Duration timeout) {
  std::erase_if(unanswered_, [&](const Unanswered& entry) { return entry.object == object; });
  unanswered_.push_back({object, Clock::now() + kLateTimeouts * timeout});
}

void LateAnswers::note_answered(ObjectAddress object, bool was_read) {
  if (expected(object)) {
    return;
  }
  unanswered_.clear();
  if (was_read && std::find(readable_.begin(), readable_.end(), object) == readable_.end()) {
    readable_.insert(readable_.begin(), object);
    readable_.resize(std::min(readable_.size(), kReadableKept));
  }
}

bool LateAnswers::expected(ObjectAddress object) {
  const TimePoint now = Clock::now();
  std::erase_if(unanswered_, [&](const Unanswered& entry) { return entry.until <= now; });
  return std::any_of(unanswered_.begin(), unanswered_.end(),
                     [&](const Unanswered& entry) { return entry.object == object; });
}

std::optional<ObjectAddress> LateAnswers::readable() {
  for (const ObjectAddress& object : readable_) {
    if (!expected(object)) {
      return object;
    }
  }
  return std::nullopt;
}

}  // namespace canopen
