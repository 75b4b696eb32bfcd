#include "bridges/mqtt/kept_topic.h"

#include <algorithm>
#include <utility>

namespace mqtt {

void KeptTopic::forget() {
  announce_ = true;
  withheld_ = false;
  word_.reset();
  put_right_.forget();
}

canopen::TimePoint KeptTopic::received(std::string_view payload, canopen::TimePoint now) {
  if (!word_) {
    return canopen::kNever;  // what comes first on this connection replaces it anyway
  }
  if (payload == *word_) {
    put_right_.forget();
    return canopen::kNever;
  }
  return put_right_.heard_another(payload == older_ ? now + PutRight::kEcho : now);
}

canopen::TimePoint KeptTopic::next() const {
  return announce_ ? canopen::TimePoint::min() : std::min(pace_.next(), put_right_.next());
}

bool KeptTopic::offer(const std::string& word, canopen::TimePoint now) {
  announce_ = false;
  const bool changed = word_ ? word_ != word : withheld_;  // What was left as it is becomes ours: a change.
  withheld_ = false;
  if (word_ && !changed && !put_right_.is_due(now)) {
    pace_.drop();
    return false;
  }
  puts_right_ = put_right_.told(now);
  if (changed) {
    older_ = std::exchange(word_, std::nullopt);
    pace_.told(now);
  } else {
    pace_.drop();  // to say a word again holds back no change of it
  }
  word_ = word;
  return true;
}

void KeptTopic::withhold() {
  announce_ = false;
  withheld_ = true;
  put_right_.forget();
  pace_.drop();
}

}  // namespace mqtt
