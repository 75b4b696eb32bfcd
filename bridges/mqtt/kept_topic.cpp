#include "bridges/mqtt/kept_topic.h"

#include <algorithm>
#include <utility>

namespace mqtt {

void KeptTopic::forget() {
  announce_ = true;
  withheld_ = false;
  word_.reset();
  wrong_ = canopen::kNever;
}

canopen::TimePoint KeptTopic::received(std::string_view payload, canopen::TimePoint now) {
  if (!word_) {
    return canopen::kNever;  // what comes first on this connection replaces it anyway
  }
  if (payload == *word_) {
    wrong_ = canopen::kNever;
    return canopen::kNever;
  }
  canopen::TimePoint at = payload == older_ ? now + kEcho : now;
  if (put_right_) {
    at = std::max(at, *put_right_ + kPutRight);
  }
  wrong_ = std::min(wrong_, at);
  return wrong_;
}

canopen::TimePoint KeptTopic::next() const {
  return announce_ ? canopen::TimePoint::min() : std::min(pace_.next(), wrong_);
}

bool KeptTopic::offer(const std::string& word, canopen::TimePoint now) {
  announce_ = false;
  const bool puts_right = wrong_ <= now;
  const bool changed = word_ ? word_ != word : withheld_;  // What was left as it is becomes ours: a change.
  withheld_ = false;
  if (word_ && !changed && !puts_right) {
    pace_.drop();
    return false;
  }
  if (puts_right) {
    put_right_ = now;
  }
  if (changed) {
    older_ = std::exchange(word_, std::nullopt);
    pace_.told(now);
  } else {
    pace_.drop();  // to say a word again holds back no change of it
  }
  word_ = word;
  wrong_ = canopen::kNever;
  return true;
}

void KeptTopic::withhold() {
  announce_ = false;
  withheld_ = true;
  wrong_ = canopen::kNever;
  pace_.drop();
}

}  // namespace mqtt
