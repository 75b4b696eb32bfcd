#pragma once

#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include "tests/support/mosquitto.h"
#include "tests/unit/mqtt/publisher_fixture.h"

namespace mqtt::test {

/// What a program writes; the commands here end by themselves (-W).
inline std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, decltype(&pclose)> pipe(popen(command.c_str(), "r"), &pclose);
  std::string output;
  std::array<char, 4096> buffer{};
  while (pipe && fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) {
    output += buffer.data();
  }
  return output;
}

/// The real publisher on a mosquitto of its own.
class OnMosquitto : public PublisherFixture {
 protected:
  void SetUp() override { ASSERT_TRUE(broker_.start()) << "is mosquitto installed?"; }

  [[nodiscard]] std::string at() const { return " -h 127.0.0.1 -p " + std::to_string(broker_.port()) + " "; }
  /// What the broker keeps there: `1 payload`, nothing where it keeps none.
  [[nodiscard]] std::string retained(const std::string& topic) const {
    return output_of("mosquitto_sub -V 5 -W 1 -C 1 -F '%r %p'" + at() + "-t " + topic + " 2>/dev/null");
  }
  [[nodiscard]] bool is_retained(const std::string& topic, const std::string& payload) {
    return run_until([&] { return retained(topic) == "1 " + payload + "\n"; });
  }
  void publish_with(const std::string& options) {
    EXPECT_EQ(output_of("mosquitto_pub" + at() + options + " 2>&1"), "");
  }
  void open() { publisher->open(connections.back()); }

  support::Mosquitto broker_;
};

}  // namespace mqtt::test
