#pragma once

#include <gtest/gtest.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/publisher.h"
#include "tests/support/spawn.h"

namespace mqtt::test {

/// The real publisher on a real loop; every wait is for a condition and bounded.
class PublisherFixture : public testing::Test, public BrokerEvents {
 public:
  void on_connected(const Connected& connection) override { connections.push_back(connection.id); }
  void on_taken_over() override { ++take_overs; }
  void on_disconnected(const std::string& why) override {
    ++disconnections;
    reasons.push_back(why);
  }
  void on_subscribed(const Subscribed& subscribed) override { grants.push_back(!subscribed.refused); }
  void on_unsubscribed(const std::string& filter) override { given_back.push_back(filter); }
  void on_message(Incoming message) override { messages.push_back(std::move(message)); }
  [[nodiscard]] bool is_stop(const Incoming& message) const override { return message.payload == "stop"; }

 protected:
  using Clock = std::chrono::steady_clock;

  static PublisherSettings settings(std::uint16_t port) {
    config::Mqtt mqtt;
    mqtt.brokers = {{"127.0.0.1", port}};
    PublisherSettings made = publisher_settings(mqtt, {"line3"});
    made.first_pause = std::chrono::milliseconds(50);
    made.longest_pause = std::chrono::milliseconds(200);
    made.pause_after_refusal = std::chrono::milliseconds(200);
    return made;
  }

  void make(PublisherSettings made) {
    publisher = std::make_unique<Publisher>(context.get_executor(), std::move(made),
                                            [this](Level, std::string text) { notices.push_back(std::move(text)); });
    publisher->start(*this);
  }

  template <class Predicate>
  [[nodiscard]] bool run_until(Predicate done, std::chrono::milliseconds limit = std::chrono::seconds(20)) {
    const auto end = Clock::now() + limit;
    while (!done()) {
      if (Clock::now() > end) {
        return false;
      }
      context.run_one_for(std::chrono::milliseconds(10));
    }
    return true;
  }

  [[nodiscard]] bool connected(std::size_t times = 1) {
    return run_until([this, times] { return connections.size() >= times; });
  }
  /// Subscribes and waits for the answers.
  [[nodiscard]] bool subscribe(std::vector<Subscription> subscriptions) {
    const std::size_t expected = grants.size() + subscriptions.size();
    publisher->subscribe(connections.back(), std::move(subscriptions));
    return run_until([this, expected] { return grants.size() >= expected; });
  }
  [[nodiscard]] bool has_message(const std::string& topic) const {
    for (const Incoming& message : messages) {
      if (message.topic == topic) {
        return true;
      }
    }
    return false;
  }
  /// How long stop() took.
  std::chrono::milliseconds stop(std::vector<Message> last = {}) {
    const auto begun = Clock::now();
    const auto done = support::spawn(context.get_executor(), publisher->stop(std::move(last)));
    EXPECT_TRUE(run_until([&done] { return *done; }));
    return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begun);
  }

  void TearDown() override { publisher.reset(); }

  boost::asio::io_context context{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{context.get_executor()};
  std::unique_ptr<Publisher> publisher;
  std::vector<ConnectionId> connections;
  std::size_t take_overs = 0;
  std::size_t disconnections = 0;
  std::vector<std::string> reasons;  ///< Of the disconnections.
  std::vector<bool> grants;
  std::vector<std::string> given_back;  ///< Filters.
  std::vector<Incoming> messages;
  std::vector<std::string> notices;
};

}  // namespace mqtt::test
