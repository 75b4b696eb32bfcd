#include "bridges/mqtt/health_topic.h"

#include <algorithm>
#include <utility>

#include "bridges/mqtt/expiry.h"

namespace mqtt {

void HealthTopic::forget() {
  told_.reset();
  next_ = canopen::TimePoint::min();
}

canopen::TimePoint HealthTopic::mark(canopen::TimePoint now) {
  if (told_) {
    next_ = std::min(next_, std::max(now, told_at_ + kPause));
  }
  return next_;
}

void HealthTopic::collect(process::Health health, canopen::TimePoint now, std::vector<Message>& out) {
  next_ = now + kPause;
  if (told_ && now < told_at_ + refresh_interval(settings_) && !process::differs(*told_, health)) {
    return;
  }
  out.push_back({.topic = topic_, .payload = process::health_json(health), .expiry = expiry_of(settings_)});
  told_ = std::move(health);
  told_at_ = now;
}

}  // namespace mqtt
