#include "bridges/mqtt/status_topic.h"

#include <algorithm>

#include "bridges/mqtt/expiry.h"
#include "bridges/mqtt/payload.h"

namespace mqtt {

using canopen::kNever;

void StatusTopic::forget() {
  online_.reset();
  echo_until_ = {};
  put_right_.forget();
}

canopen::TimePoint StatusTopic::received(std::string_view payload, canopen::TimePoint now) {
  if (!online_) {
    return kNever;  // what comes first on this connection replaces it anyway
  }
  if (payload == online_text(*online_)) {
    put_right_.forget();
    return kNever;
  }
  const bool may_be_ours = payload == online_text(!*online_) && now < echo_until_;
  return put_right_.heard_another(may_be_ours ? echo_until_ : now);
}

canopen::TimePoint StatusTopic::next() const {
  if (!online_) {
    return canopen::TimePoint::min();
  }
  // `offline` is true for ever.
  const bool expires = *online_ && expiry_of(*settings_) != 0;
  return std::min(put_right_.next(), expires ? published_ + refresh_interval(*settings_) : kNever);
}

void StatusTopic::collect(bool online, canopen::TimePoint now, std::vector<Message>& out) {
  const bool changed = online_ && *online_ != online;
  if (online_ && !changed && now < next()) {
    return;
  }
  const bool first = !online_;
  const bool puts_right = put_right_.told(now);
  if (changed) {
    echo_until_ = now + PutRight::kEcho;
  }
  online_ = online;
  published_ = now;
  Message message = offline();
  message.puts_right = puts_right;
  if (online) {
    message.payload = online_text(true);
    message.expiry = expiry_of(*settings_);
  }
  message.after_all = after_all_ && first;
  out.push_back(std::move(message));
}

Message StatusTopic::offline() const {
  return {.topic = *topic_, .payload = online_text(false), .kind = MessageKind::status, .after_all = after_all_};
}

}  // namespace mqtt
