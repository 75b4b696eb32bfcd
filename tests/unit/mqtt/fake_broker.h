#pragma once

#include <gtest/gtest.h>

#include <boost/asio/awaitable.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/broker.h"

namespace mqtt::test {

/// A broker that a test plays: it records what is published and tells what the test says.
class FakeBroker final : public Broker {
 public:
  void start(BrokerEvents& to_events) override { events = &to_events; }
  void subscribe(ConnectionId connection, std::vector<Subscription> subscriptions) override {
    if (connection != subscribed_on) {
      subscribed.clear();
      unanswered.clear();
    }
    subscribed_on = connection;
    subscribed.insert(subscribed.end(), subscriptions.begin(), subscriptions.end());
    unanswered.insert(unanswered.end(), subscriptions.begin(), subscriptions.end());
  }
  void unsubscribe(ConnectionId connection, std::string filter) override {
    unsubscribed_on = connection;
    unsubscribed.push_back(std::move(filter));
  }
  void publish(std::vector<Message> batch) override {
    ++batches;
    for (Message& message : batch) {
      if (message.retained) {
        retained[message.topic] = message.payload;
      }
      published.push_back(std::move(message));
    }
  }
  void open(ConnectionId connection) override { opened = connection; }
  /// The test tells on_disconnected() itself.
  void drop(ConnectionId connection, std::string why) override {
    dropped = connection;
    dropped_why = std::move(why);
  }
  /// The test tells on_disconnected() itself.
  void leave(ConnectionId connection, std::vector<Message> last) override {
    left = connection;
    last_words = std::move(last);
  }
  void suspect_takeover(ConnectionId connection) override { suspected = connection; }
  [[nodiscard]] BrokerCounts counts() const override { return counted; }
  [[nodiscard]] bool alive() const override { return true; }
  [[nodiscard]] bool ended() const override { return true; }
  boost::asio::awaitable<void> stop(std::vector<Message> last) override {
    last_words = std::move(last);
    if (while_stopping) {
      while_stopping();
    }
    stopped = true;
    co_return;
  }

  /// Answers every subscription that is not answered, and those that are asked for then: with `refused` all of them, or
  /// `only` this one. The look through the tree is refused, so that no time has to pass.
  void answer_subscriptions(const std::optional<std::string>& refused = std::nullopt, const std::string& only = {}) {
    while (!unanswered.empty()) {
      const std::vector<Subscription> asked = std::exchange(unanswered, {});
      for (const Subscription& each : asked) {
        Subscribed answer{.filter = each.filter};
        if (each.bulk || only.empty() || each.filter == only) {
          answer.refused = each.bulk ? refused.value_or("no look") : refused;
        }
        events->on_subscribed(answer);
      }
    }
  }
  /// What was subscribed with this filter on this connection; one without a filter where nothing was.
  [[nodiscard]] Subscription subscription(const std::string& filter) const {
    for (const Subscription& each : subscribed) {
      if (each.filter == filter) {
        return each;
      }
    }
    ADD_FAILURE() << "not subscribed: " << filter;
    return {};
  }
  /// What was published on one topic last.
  [[nodiscard]] Message newest(const std::string& topic) const {
    for (auto message = published.rbegin(); message != published.rend(); ++message) {
      if (message->topic == topic) {
        return *message;
      }
    }
    ADD_FAILURE() << "not published: " << topic;
    return {};
  }
  /// Payloads published on one topic, in order.
  [[nodiscard]] std::vector<std::string> on(const std::string& topic) const {
    std::vector<std::string> payloads;
    for (const Message& message : published) {
      if (message.topic == topic) {
        payloads.push_back(message.payload);
      }
    }
    return payloads;
  }
  void forget() {
    published.clear();
    batches = 0;
  }

  BrokerEvents* events = nullptr;
  ConnectionId subscribed_on = 0;
  std::vector<Subscription> subscribed;  ///< On this connection.
  std::vector<Subscription> unanswered;  ///< Of them.
  ConnectionId unsubscribed_on = 0;
  std::vector<std::string> unsubscribed;  ///< Since the start.
  std::vector<Message> published;
  std::map<std::string, std::string> retained;
  std::size_t batches = 0;
  ConnectionId opened = 0;
  ConnectionId dropped = 0;
  std::string dropped_why;
  ConnectionId suspected = 0;  ///< Of a take-over.
  ConnectionId left = 0;
  std::vector<Message> last_words;
  std::function<void()> while_stopping;  ///< What happens while the last words leave.
  bool stopped = false;
  BrokerCounts counted;
};

}  // namespace mqtt::test
