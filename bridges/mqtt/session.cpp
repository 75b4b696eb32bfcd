#include "bridges/mqtt/session.h"

#include <algorithm>
#include <utility>

namespace mqtt {
namespace {

using canopen::kNever;
constexpr auto kEmcy = static_cast<std::size_t>(alarms::AlarmKind::emcy);

}  // namespace

Session::Session(Broker& broker, const Topics& topics, std::size_t drives)
    : broker_(broker), topics_(topics), alarm_known_(drives) {}

void Session::connected(ConnectionId connection, canopen::TimePoint now) {
  connection_ = connection;
  phase_ = Phase::subscribing;
  deadline_ = now + kSubscribePatience;
  std::vector<Subscription> subscriptions = topics_.command_subscriptions();
  if (!read_back_) {
    // QoS 0: the broker sends them all at once, whatever it allows to be under way.
    for (std::string& topic : alarm_topics()) {
      subscriptions.push_back({std::move(topic), 0});
    }
  }
  broker_.subscribe(connection, std::move(subscriptions));
}

void Session::lost() {
  phase_ = Phase::offline;
  deadline_ = kNever;
}

void Session::subscribed(canopen::TimePoint now) {
  if (phase_ != Phase::subscribing) {
    return;
  }
  if (read_back_ || all_known()) {  // some brokers send retained messages before this answer
    finish();
    return;
  }
  phase_ = Phase::reading_back;
  deadline_ = now + kReadBack;
}

void Session::alarm_came(std::size_t drive) {
  alarm_known_.at(drive) = true;
  if (phase_ == Phase::reading_back && all_known()) {
    finish();
  }
}

void Session::tick(canopen::TimePoint now) {
  if (now >= deadline_ && (phase_ == Phase::subscribing || phase_ == Phase::reading_back)) {
    finish();
  }
}

bool Session::reads_back() const noexcept {
  return !read_back_ && (phase_ == Phase::subscribing || phase_ == Phase::reading_back);
}

bool Session::all_known() const noexcept {
  return std::find(alarm_known_.begin(), alarm_known_.end(), false) == alarm_known_.end();
}

std::vector<std::string> Session::alarm_topics() const {
  std::vector<std::string> topics;
  for (std::size_t i = 0; i < alarm_known_.size(); ++i) {
    topics.push_back(topics_.drive(i).alarms.at(kEmcy));
  }
  return topics;
}

void Session::finish() {
  if (!read_back_) {
    read_back_ = true;
    if (!alarm_known_.empty()) {
      broker_.unsubscribe(connection_, alarm_topics());
    }
  }
  phase_ = Phase::ready;
  deadline_ = kNever;
}

}  // namespace mqtt
