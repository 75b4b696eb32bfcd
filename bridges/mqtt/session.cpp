#include "bridges/mqtt/session.h"

#include <utility>
#include <vector>

namespace mqtt {

using canopen::kNever;

void Session::connected(ConnectionId connection, canopen::TimePoint now) {
  connection_ = connection;
  phase_ = Phase::subscribing;
  deadline_ = now + kSubscribePatience;
  std::vector<Subscription> subscriptions = topics_.command_subscriptions();
  for (Subscription& watched : topics_.watched_subscriptions()) {
    subscriptions.push_back(std::move(watched));
  }
  awaited_ = subscriptions.size();
  broker_.subscribe(connection, std::move(subscriptions));
}

void Session::lost() {
  phase_ = Phase::offline;
  deadline_ = kNever;
}

void Session::subscribed() {
  if (phase_ == Phase::subscribing && --awaited_ == 0) {
    finish();
  }
}

void Session::tick(canopen::TimePoint now) {
  if (now >= deadline_ && phase_ == Phase::subscribing) {
    finish();
  }
}

void Session::finish() {
  phase_ = Phase::ready;
  deadline_ = kNever;
}

}  // namespace mqtt
