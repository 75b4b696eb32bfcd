#include "bridges/mqtt/session.h"

#include <algorithm>
#include <utility>

namespace mqtt {

using canopen::kNever;

namespace {

// What goes wrong where it is refused.
std::string lost_by(const Subscription& subscription) {
  if (!subscription.watched) {
    return "Commands that come there do not arrive";
  }
  return subscription.lost.empty() ? "What others write there is not put right" : std::string(subscription.lost);
}

}  // namespace

void Session::connected(const Connected& connection, canopen::TimePoint now) {
  connection_ = connection.id;
  place_ = &places_[place_of(connection)];
  looked_here_ = !place_->looked;
  entries_.clear();
  if (looked_here_) {
    look_until_ = now + kSubscribePatience;
    quiet_at_ = look_until_;
    answered_ = false;
    phase_ = Phase::looking;
    broker_.subscribe(connection_, {topics_.tree_subscription()});
  } else {
    ask(Phase::subscribing, topics_.command_subscriptions(), now);
  }
}

void Session::lost() {
  if (phase_ == Phase::offline) {
    return;
  }
  const bool looking = phase_ == Phase::looking;
  const bool look_breaks = looking && ++place_->look_breaks >= kLookBreaks;
  const std::string suspect = unanswered();
  const bool again = !suspect.empty() && suspect == place_->suspect;
  place_->suspect = again ? std::string() : suspect;
  if (again || look_breaks) {
    leave_out(looking ? topics_.tree_subscription().filter : suspect, look_breaks ? "three times" : "twice");
  }
  phase_ = Phase::offline;
  entries_.clear();
}

void Session::leave_out(const std::string& filter, const std::string& times) {
  const bool look = filter == topics_.tree_subscription().filter;
  const auto entry = std::ranges::find(entries_, filter, [](const Entry& each) { return each.subscription.filter; });
  if (look) {
    place_->looked = true;
  } else {
    place_->left_out.insert(filter);
  }
  notice_(Level::error, "MQTT: " + times + " in a row the connection broke at the subscription to " + filter +
                            ": it is left out at this broker until the gateway's next start. " +
                            (look || entry == entries_.end() ? "Topics of drives and signals that are gone stay there"
                                                             : lost_by(entry->subscription)) +
                            "; give the gateway's user the right to read there");
}

std::string Session::unanswered() const {
  if (phase_ == Phase::looking) {
    return answered_ ? std::string() : topics_.tree_subscription().filter;
  }
  // Brokers answer in order.
  const auto entry = std::find_if(entries_.begin(), entries_.end(), [](const Entry& each) {
    return each.subscription.watched && (each.state == Entry::State::asked || each.unanswered >= kTries);
  });
  return entry == entries_.end() ? std::string() : entry->subscription.filter;
}

void Session::ask(Phase phase, std::vector<Subscription> subscriptions, canopen::TimePoint now) {
  phase_ = phase;
  for (const Subscription& subscription : subscriptions) {
    entries_.push_back({.subscription = subscription, .at = now + kSubscribePatience});
  }
  broker_.subscribe(connection_, std::move(subscriptions));
}

bool Session::sets_aside(const Incoming& message, canopen::TimePoint now) {
  if (message.retained) {
    quiet_at_ = now + kQuiet;
  }
  return phase_ == Phase::offline || phase_ == Phase::looking || phase_ == Phase::leaving;
}

void Session::stray(const Incoming& message) {
  if (std::exchange(looked_here_, false)) {
    give_up("the broker goes on sending what is not subscribed to any more, such as " + message.topic);
  }
}

void Session::give_up(std::string why) {
  broker_.drop(connection_, std::move(why));
  lost();
}

void Session::say_no_look(const std::string& why) {
  notice_(Level::warning, "MQTT: the subscription to " + topics_.tree_subscription().filter + " is refused: " + why +
                              ". Topics of drives and signals that are gone stay there");
}

void Session::leave(canopen::TimePoint now) {
  place_->looked = true;
  look_until_ = now + kSubscribePatience;
  phase_ = Phase::leaving;
  broker_.unsubscribe(connection_, topics_.tree_subscription().filter);
}

void Session::unsubscribed(canopen::TimePoint now) {
  if (phase_ == Phase::leaving) {
    ask(Phase::subscribing, topics_.command_subscriptions(), now);
  }
}

void Session::subscribed(const Subscribed& answer, canopen::TimePoint now) {
  if (phase_ == Phase::looking) {
    quiet_at_ = now + kQuiet;
    answered_ = true;
    if (answer.refused) {
      place_->looked = true;
      looked_here_ = false;
      say_no_look(*answer.refused);
      ask(Phase::subscribing, topics_.command_subscriptions(), now);
    }
    return;
  }
  const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                  [&answer](const Entry& each) { return each.subscription.filter == answer.filter; });
  if (entry == entries_.end()) {
    return;
  }
  if (answer.refused) {
    entry->unanswered = 0;
    refuse(*entry, *answer.refused, now);
  } else {
    entry->state = Entry::State::granted;
    entry->at = kNever;
    entry->unanswered = 0;
    if (said_.erase(answer.filter) != 0) {
      notice_(Level::info, "MQTT: the broker grants the subscription to " + answer.filter + " now");
    }
  }
  finish(now);
}

void Session::tick(canopen::TimePoint now) {
  if (phase_ == Phase::looking && now >= std::min(quiet_at_, look_until_)) {
    if (!answered_) {
      say_no_look("no answer within 10 s");
    }
    leave(now);
  } else if (phase_ == Phase::leaving && now >= look_until_) {
    give_up("the broker does not end the subscription to " + topics_.tree_subscription().filter);
  }
  std::vector<Subscription> again;
  for (Entry& entry : entries_) {
    if (now < entry.at) {
      continue;
    }
    if (entry.state == Entry::State::asked) {
      refuse(entry, "no answer within 10 s", now);
      if (++entry.unanswered == kTries) {
        give_up("the broker does not answer the subscription to " + entry.subscription.filter);
        return;
      }
    } else {
      entry.state = Entry::State::asked;
      entry.at = now + kSubscribePatience;
      again.push_back(entry.subscription);
    }
  }
  if (!again.empty()) {
    broker_.subscribe(connection_, std::move(again));
  }
  finish(now);
}

canopen::TimePoint Session::deadline() const noexcept {
  if (phase_ == Phase::looking || phase_ == Phase::leaving) {
    return phase_ == Phase::looking ? std::min(quiet_at_, look_until_) : look_until_;
  }
  canopen::TimePoint next = kNever;
  for (const Entry& entry : entries_) {
    next = std::min(next, entry.at);
  }
  return next;
}

std::vector<std::string> Session::refused() const {
  std::vector<std::string> filters;
  if (phase_ != Phase::offline) {
    filters.assign(place_->left_out.begin(), place_->left_out.end());
  }
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
    notice_(Level::error, "MQTT: the subscription to " + entry.subscription.filter + " is refused: " + why + ". " +
                              lost_by(entry.subscription) +
                              ". It is tried again; give the gateway's user the right to read there");
  }
}

void Session::ask_watched(canopen::TimePoint now) {
  std::vector<Subscription> watched = topics_.watched_subscriptions();
  watched.insert(watched.end(), watched_too_.begin(), watched_too_.end());
  std::erase_if(watched, [this](const Subscription& each) { return place_->left_out.contains(each.filter); });
  ask(Phase::watching, std::move(watched), now);
}

// All were answered once, or nobody waits for them any more.
void Session::finish(canopen::TimePoint now) {
  const bool waits = std::any_of(entries_.begin(), entries_.end(), [](const Entry& entry) {
    return entry.state == Entry::State::asked && entry.pause == kFirstPause;
  });
  if (waits) {
    return;
  }
  if (phase_ == Phase::subscribing) {
    ask_watched(now);
  } else if (phase_ == Phase::watching) {
    phase_ = Phase::ready;
  }
}

}  // namespace mqtt
