// What the broker tells the bridge, and how it is left for another one.

#include <algorithm>
#include <utility>

#include "bridges/mqtt/bridge.h"
#include "bridges/process/command_checks.h"

namespace mqtt {
namespace {

// Whether a broker may be left now, where it may be at the next good moment.
constexpr canopen::Duration kLeaveCheck = std::chrono::seconds(1);

}  // namespace

void Bridge::on_connected(const Connected& connection) {
  if (stopping_) {
    return;  // the last words are said
  }
  connection_ = connection;
  may_leave_ = leaving_ = said_why_not_ = false;
  const std::string place = place_of(connection);
  session_.connected(connection, canopen::Clock::now());
  leftovers_.connected(place);
  other_.connected(place);
  home_assistant_.connected(place);
  session_.watch_too(home_assistant_.subscriptions());
  wake(session_.deadline());
}

void Bridge::on_taken_over() {
  other_.took_over(canopen::Clock::now());
}

void Bridge::on_may_leave(ConnectionId connection, bool may) {
  if (connection_ && connection == connection_->id && !stopping_ && !leaving_) {
    may_leave_ = may;
    wake(canopen::Clock::now());
  }
}

canopen::TimePoint Bridge::leave_if_ready(canopen::TimePoint now) {
  if (!may_leave_ || stopping_ || !session_.ready()) {
    return canopen::kNever;
  }
  const std::string drives = drives_that_count_on_mqtt();
  if (!drives.empty() && !std::exchange(said_why_not_, true)) {
    notice_(
        Level::info,
        "MQTT: the first broker takes connections again; " + connection_->broker +
            " is left for it when no drive runs whose `timeout` waits for signs of life by MQTT, as now: " + drives);
  }
  if (drives.empty() && requests_.is_idle()) {
    leave();
    return canopen::kNever;
  }
  return now + kLeaveCheck;
}

std::string Bridge::drives_that_count_on_mqtt() const {
  std::string names;
  for (std::size_t i = 0; i < plant_.size(); ++i) {
    const process::Drive& drive = plant_.drive(i);
    if (drive.counts_on(mqtt_writer()) && !process::refuse_writer(drive.model(), mqtt_writer())) {
      names += (names.empty() ? "" : ", ") + drive.model().name;
    }
  }
  return names;
}

void Bridge::leave() {
  may_leave_ = false;
  leaving_ = true;
  broker_->leave(session_.connection(), last_words());
  session_.lost();
  follow_session();
}

void Bridge::on_disconnected(const std::string& why) {
  connection_.reset();
  may_leave_ = leaving_ = false;
  last_break_ = why;
  // Whatever is retained is told again on the next connection, if it is still there then.
  std::erase_if(batch_, [](const Message& message) { return message.kind != MessageKind::answer; });
  session_.lost();
  other_.lost();
  leftovers_.lost(canopen::Clock::now());
  follow_session();
}

void Bridge::on_subscribed(const Subscribed& subscribed) {
  if (stopping_) {
    return;
  }
  if (session_.ready() && !subscribed.refused) {
    tell_again();  // what others wrote meanwhile was not heard
  }
  if (!subscribed.refused) {
    home_assistant_.granted(subscribed.filter);
  }
  session_.subscribed(subscribed, canopen::Clock::now());
  wake(session_.deadline());
  follow_session();
  health_may_differ();
}

void Bridge::on_unsubscribed(const std::string& /*filter*/) {
  if (stopping_) {
    return;
  }
  session_.unsubscribed(canopen::Clock::now());  // nothing else is ever given back
  wake(session_.deadline());
}

void Bridge::on_message(Incoming message) {
  if (leaving_) {
    requests_.come_too_late(message);
    return;
  }
  // A stop counts however it comes: carried out twice it does no harm, lost it does.
  if (session_.sets_aside(message, canopen::Clock::now()) && !requests_.is_stop(message)) {
    looked_at(message);
    return;
  }
  const auto route = topics_.route(message.topic);
  if (!route) {
    elsewhere(message);
  } else if (route->kind == Route::Kind::alarm) {
    wake(alarms_.received(message, canopen::Clock::now()));
  } else if (route->kind == Route::Kind::status) {
    status_received(message, *route);
  } else if (route->kind == Route::Kind::life) {
    if (other_.heard(message, canopen::Clock::now())) {
      broker_->suspect_takeover(session_.connection());
    }
    wake(other_.next());
  } else {
    requests_.handle(message, *route);
  }
}

void Bridge::looked_at(const Incoming& message) {
  leftovers_.heard(message);
  if (message.retained && message.topic == topics_.home_assistant()) {
    home_assistant_.prefixes_kept(message.payload);
    session_.watch_too(home_assistant_.subscriptions());
  }
}

void Bridge::elsewhere(const Incoming& message) {
  if (home_assistant_.heard(message, canopen::Clock::now())) {
    wake(std::min(home_assistant_.next(), leftovers_.next()));
    return;
  }
  session_.stray(message);
  follow_session();
}

void Bridge::status_received(const Incoming& message, const Route& route) {
  if (message.retained) {
    return;  // the broker kept it from before it was subscribed to (MQTT 3.1.1): older than all that we said since
  }
  const canopen::TimePoint now = canopen::Clock::now();
  if (route.drive.empty()) {
    wake(status_.received(message.payload, now));
  } else if (const process::Drive* drive = plant_.find(route.drive)) {
    wake(feeds_[drive->index()].status_received(message.payload, now));
  }
}

process::BrokerHealth Bridge::broker_health() const {
  process::BrokerHealth health{.refused = session_.refused(), .last_break = last_break_};
  if (connection_) {
    health.broker = connection_->broker;
    health.protocol = connection_->version == 5 ? "5" : "3.1.1";
  }
  const BrokerCounts counts = broker_->counts();
  health.other = other_.who();
  health.put_right = put_right_.count();
  health.messages_dropped = counts.messages_dropped;
  health.answers_dropped = counts.answers_dropped;
  return health;
}

void Bridge::tell_again() {
  alarms_.mark_all();
  status_.forget();
  for (Feed& feed : feeds_) {
    feed.forget_status();
  }
  wake(canopen::Clock::now());
}

}  // namespace mqtt
