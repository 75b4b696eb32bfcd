#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/traffic.h"
#include "tests/unit/mqtt/messages.h"

namespace mqtt::test {

/// What goes to a broker, at a time that the test moves by hand.
class TrafficTest : public testing::Test {
 protected:
  using Texts = std::vector<std::string>;

  void SetUp() override { begin(); }

  void begin(const BrokerLimits& limits = {}) {
    traffic_.begin(limits, 5, now_);
    traffic_.open();
  }
  void push(std::vector<Message> batch) { traffic_.push(std::move(batch), now_); }
  /// Sends what may leave.
  std::vector<const Message*> send() {
    std::vector<const Message*> sent;
    while (traffic_.may_send(now_)) {
      if (const Message* const message = traffic_.next(now_)) {
        sent.push_back(message);
      }
    }
    return sent;
  }
  void acknowledge(const Message* message, Delivery delivery = Delivery::done, int code = 0) {
    traffic_.acknowledged(message, delivery, code, now_);
  }
  /// Sends until nothing may leave, acknowledging each; but a broker that hates a topic ends the connection there.
  Texts send_to(const std::string& hated) {
    Texts taken;
    for (auto sent = send(); !sent.empty(); sent = send()) {
      for (const Message* const message : sent) {
        if (message->topic == hated) {
          traffic_.end(true, now_);
          return taken;
        }
        taken.push_back(message->topic + "=" + message->payload);
        acknowledge(message);
      }
    }
    return taken;
  }
  /// As the bridge does with each connection.
  Texts announce_to(const std::string& hated, const std::string& payload = "1") {
    begin();
    push({value("a", "1"), value("bad", payload), value("c", "1"), status("B", "online", true)});
    return send_to(hated);
  }

  Texts said_;
  Traffic traffic_{1, [this](Level, std::string text) { said_.push_back(std::move(text)); }};
  Traffic::TimePoint now_{std::chrono::hours(1)};
};

}  // namespace mqtt::test
