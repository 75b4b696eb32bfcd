#include "bridges/mqtt/session.h"

#include <algorithm>
#include <utility>

namespace mqtt {

using canopen::kNever;

void Session::connected(ConnectionId connection, canopen::TimePoint now) {
  connection_ = connection;
  phase_ = Phase::subscribing;
  std::vector<Subscription> subscriptions = topics_.command_subscriptions();
  for (Subscription& watched : topics_.watched_subscriptions()) {
    subscriptions.push_back(std::move(watched));
  }
  entries_.clear();
  for (const Subscription& subscription : subscriptions) {
    entries_.push_back({.subscription = subscription, .at = now + kSubscribePatience});
  }
  broker_.subscribe(connection, std::move(subscriptions));
}

void Session::lost() {
  phase_ = Phase::offline;
  entries_.clear();
}

void Session::subscribed(const Subscribed& answer, canopen::TimePoint now) {
  const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                  [&answer](const Entry& each) { return each.subscription.filter == answer.filter; });
  if (entry == entries_.end()) {
    return;
  }
  if (answer.refused) {
    refuse(*entry, *answer.refused, now);
  } else {
    entry->state = Entry::State::granted;
    entry->at = kNever;
    if (said_.erase(answer.filter) != 0) {
      notice_(Level::info, "MQTT: the broker grants the subscription to " + answer.filter + " now");
    }
  }
  finish();
}

void Session::tick(canopen::TimePoint now) {
  std::vector<Subscription> again;
  for (Entry& entry : entries_) {
    if (now < entry.at) {
      continue;
    }
    if (entry.state == Entry::State::asked) {
      refuse(entry, "no answer within 10 s", now);
    } else {
      entry.state = Entry::State::asked;
      entry.at = now + kSubscribePatience;
      again.push_back(entry.subscription);
    }
  }
  if (!again.empty()) {
    broker_.subscribe(connection_, std::move(again));
  }
  finish();
}

canopen::TimePoint Session::deadline() const noexcept {
  canopen::TimePoint next = kNever;
  for (const Entry& entry : entries_) {
    next = std::min(next, entry.at);
  }
  return next;
}

std::vector<std::string> Session::refused() const {
  std::vector<std::string> filters;
  for (const Entry& entry : entries_) {
    // One that is tried again is as it was until it is answered.
    if (entry.state == Entry::State::refused || (entry.state == Entry::State::asked && entry.pause != kFirstPause)) {
      filters.push_back(entry.subscription.filter);
    }
  }
  return filters;
}

void Session::refuse(Entry& entry, const std::string& why, canopen::TimePoint now) {
  entry.state = Entry::State::refused;
  entry.at = now + entry.pause;
  entry.pause = std::min(2 * entry.pause, kLongestPause);
  if (said_.insert(entry.subscription.filter).second) {
    notice_(Level::error, "MQTT: the subscription to " + entry.subscription.filter + " is refused: " + why +
                              (entry.subscription.watched ? ". What others write there is not put right"
                                                          : ". Commands that come there do not arrive") +
                              ". It is tried again; give the gateway's user the right to read there");
  }
}

// All were answered once, or nobody waits for them any more.
void Session::finish() {
  const bool waits = std::any_of(entries_.begin(), entries_.end(), [](const Entry& entry) {
    return entry.state == Entry::State::asked && entry.pause == kFirstPause;
  });
  if (phase_ == Phase::subscribing && !waits) {
    phase_ = Phase::ready;
  }
}

}  // namespace mqtt
