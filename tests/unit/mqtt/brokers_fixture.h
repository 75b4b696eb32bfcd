#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/mosquitto.h"
#include "tests/unit/mqtt/on_mosquitto.h"
#include "tests/unit/mqtt/publisher_fixture.h"

namespace mqtt::test {

inline constexpr const char* kBrokerStatus = "canopen/line3/status";
/// What is promised.
inline constexpr auto kOverWithin = std::chrono::seconds(10);

class Brokers : public PublisherFixture {
 public:
  void on_connected(const Connected& connection) override {
    PublisherFixture::on_connected(connection);
    used.push_back(connection.broker);
    // As the bridge does.
    publisher->publish({{.topic = kBrokerStatus, .payload = "online", .kind = MessageKind::status, .after_all = true}});
    publisher->open(connection.id);
  }
  void on_may_leave(ConnectionId connection, bool may) override {
    ++offers;
    if (!may) {
      return;
    }
    publisher->leave(connection,
                     {{.topic = "canopen/line3/pump1/status", .payload = "offline"},
                      {.topic = kBrokerStatus, .payload = "gone", .kind = MessageKind::status, .after_all = true}});
  }
  void on_no_connection(const std::string& why) override { failures.push_back(why); }

 protected:
  static std::string name(std::uint16_t port) { return "127.0.0.1:" + std::to_string(port); }
  static PublisherSettings of(const std::vector<std::uint16_t>& ports) {
    PublisherSettings made = settings(ports.front());
    made.brokers.clear();
    for (const std::uint16_t port : ports) {
      made.brokers.push_back({"127.0.0.1", port});
    }
    made.pause_after_refusal = std::chrono::seconds(60);
    // As patient as a real one, but for the scale: what each of them is for a real one is told by PublisherSettings.
    made.quiet = std::chrono::milliseconds(500);
    made.stalled = std::chrono::milliseconds(1500);
    made.hurried = std::chrono::milliseconds(1500);
    return made;
  }
  /// Of one who is back at the first as soon as it was reachable for a moment.
  static PublisherSettings homesick(const std::vector<std::uint16_t>& ports) {
    PublisherSettings made = of(ports);
    made.return_after = std::chrono::milliseconds(600);
    made.look_interval = std::chrono::seconds(
        1);  // three of them missed begin the time anew, and the thread looks about each half second
    return made;
  }
  [[nodiscard]] bool is_in_use(std::uint16_t port, std::chrono::milliseconds limit = kOverWithin) {
    return run_until([&] { return connections.size() > disconnections && used.back() == name(port); }, limit);
  }
  [[nodiscard]] bool is_said(const std::string& part) const {
    return std::ranges::any_of(notices, [&part](const auto& text) { return text.find(part) != std::string::npos; });
  }
  [[nodiscard]] static std::string retained(const support::Mosquitto& broker, const std::string& topic) {
    return output_of("mosquitto_sub -V 5 -W 1 -C 1 -F '%r %p' -h 127.0.0.1 -p " + std::to_string(broker.port()) +
                     " -t " + topic + " 2>/dev/null");
  }
  [[nodiscard]] bool is_retained(const support::Mosquitto& broker, const std::string& payload) {
    return run_until([&] { return retained(broker, kBrokerStatus) == "1 " + payload + "\n"; });
  }

  std::vector<std::string> used;  ///< Brokers, in the order of their connections.
  std::vector<std::string> failures;
  std::size_t offers = 0;  ///< Of the way back.
};

class TwoBrokers : public Brokers {
 protected:
  void SetUp() override {
    ASSERT_TRUE(first_.start());
    ASSERT_TRUE(second_.start());
  }
  void begin(PublisherSettings made) {
    make(std::move(made));
    ASSERT_TRUE(is_in_use(first_.port()));
    ASSERT_TRUE(is_retained(first_, "online"));
  }

  [[nodiscard]] std::string second_name() const { return "second.example:" + std::to_string(second_.port()); }

  support::Mosquitto first_;
  support::Mosquitto second_;
};

}  // namespace mqtt::test
