// The whole way from simulated drives to two real brokers: what each of them holds when the first freezes, the second
// is used, and the first is used again. The test's time goes with that of the brokers.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <future>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/bridge.h"
#include "bridges/mqtt/publisher.h"
#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/subscription.h"
#include "canopen/bus/virtual_link.h"
#include "config/load.h"
#include "simulator/drive.h"
#include "simulator/network.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/mosquitto.h"
#include "tests/support/spawn.h"
#include "tests/unit/mqtt/on_mosquitto.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;
using support::Mosquitto;
using Tree = std::map<std::string, std::string>;

constexpr std::uint16_t kTripCode = 0x0006;
/// What is promised.
constexpr auto kFailOver = 10s;
constexpr const char* kCommand = R"({"value":49.5,"id":"a1"})";

config::Model model_of_two_brokers(const Mosquitto& first, const Mosquitto& second) {
  const auto at = [](const Mosquitto& broker) { return "\"mqtt://127.0.0.1:" + std::to_string(broker.port()) + "\""; };
  std::string site =
      "[gateway]\nname = \"line3\"\n[[bus]]\nname = \"can0\"\ninterface = \"virtual\"\n[mqtt]\nbrokers = [" +
      at(first) + ", " + at(second) + "]\n";
  for (const char* const drive : {"name = \"fan1\"\nnode = 1", "name = \"fan2\"\nnode = 2"}) {
    site +=
        "[[drive]]\n" + std::string(drive) + "\nprofile = \"veichi-ac310\"\n[drive.commands]\nwriters = [\"mqtt\"]\n";
  }
  config::Loaded loaded = config::load_text(
      site, {.file = "site.toml", .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = "host"});
  if (!loaded.model) {
    throw std::invalid_argument("the site does not load: " + config::to_string(loaded.findings.front()));
  }
  return *std::move(loaded.model);
}

PublisherSettings settings_of_the_homesick(const config::Model& model) {
  PublisherSettings made = publisher_settings(*model.mqtt, model.gateway);
  made.return_after = 1500ms;
  made.look_interval = 1s;
  made.quiet = 500ms;
  made.stalled = 1500ms;
  return made;
}

class FailOver : public testing::Test {
 protected:
  FailOver() {
    if (!first_.start() || !second_.start()) {
      throw std::runtime_error("is mosquitto installed?");
    }
    model_ = model_of_two_brokers(first_, second_);
    plant_ = std::make_unique<process::Plant>(
        loop_.executor(), model_, std::vector<process::Plant::BusPort>{{&bus_, [this] { return bus_.statistics(); }}});
    bus_state_ = bus_.subscribe_state([this](const canopen::BusState& state) { plant_->set_bus_state(0, state); });
    bridge_ =
        std::make_unique<Bridge>(loop_.executor(), *plant_, *model_.mqtt, model_.gateway, "1.2.3", "00112233aabbccdd",
                                 std::make_unique<Publisher>(loop_.executor(), settings_of_the_homesick(model_),
                                                             [](Level, const std::string&) {}),
                                 [](Level, const std::string&) {});
    network_.open();
    for (const std::uint8_t node : {std::uint8_t{1}, std::uint8_t{2}}) {
      drives_.push_back(simulator::make_drive("veichi-ac310", node, network_));
      drives_.back()->power_on();
    }
    plant_->add(*bridge_);
    bridge_->start();
    bus_.start();
    plant_->start();
  }
  ~FailOver() override {
    const auto ended = support::spawn(loop_.executor(), [](FailOver& site) -> boost::asio::awaitable<void> {
      co_await site.bridge_->stop();
      co_await site.plant_->stop();
      co_await site.bus_.stop();
    }(*this));
    EXPECT_TRUE(run_until([&ended] { return *ended; }, 20s));
  }

  /// As much time passes in the test as outside.
  template <class Predicate>
  [[nodiscard]] bool run_until(Predicate done, std::chrono::milliseconds limit) {
    const auto end = steady_clock::now() + limit;
    for (auto passed = steady_clock::now(); !done(); passed = steady_clock::now()) {
      if (passed > end) {
        return false;
      }
      loop_.context().run_one_for(5ms);
      loop_.advance(steady_clock::now() - passed, 5ms);
    }
    return true;
  }
  std::string output_of(const std::string& command) {
    auto output = std::async(std::launch::async, [&command] { return test::output_of(command); });
    EXPECT_TRUE(run_until([&output] { return output.wait_for(0s) == std::future_status::ready; }, 20s));
    return output.get();
  }
  static std::string at(const Mosquitto& broker) {
    return " -V 5 -h 127.0.0.1 -p " + std::to_string(broker.port()) + " ";
  }
  /// All that a broker keeps of the gateway, without the part of the topics that all have.
  Tree tree(const Mosquitto& broker) {
    std::istringstream lines(
        output_of("mosquitto_sub -t 'canopen/line3/#' --retained-only -W 1 -F '%t %p'" + at(broker) + "2>/dev/null"));
    Tree kept;
    for (std::string line; std::getline(lines, line);) {
      const std::string topic = line.substr(0, line.find(' '));
      kept.emplace(topic.substr(std::string("canopen/line3/").size()), line.substr(line.find(' ') + 1));
    }
    return kept;
  }
  /// What it keeps once all of `all` has come there, the alarm is active, and what was there before is emptied; or what
  /// it keeps at last, ten seconds later. It keeps what it had of us before until the truth has come.
  Tree settled_tree(const Mosquitto& broker, const Tree& all) {
    Tree kept;
    for (int tries = 0; tries < 10; ++tries) {
      kept = tree(broker);
      const bool whole = std::ranges::all_of(all, [&kept](const auto& each) { return kept.contains(each.first); });
      if (whole && is_active(kept) && !kept.contains("old/status") && !kept.contains("fan1/nmt/set")) {
        break;
      }
    }
    return kept;
  }
  /// Which is a connection in which all was said.
  [[nodiscard]] bool is_in_use(const Mosquitto& broker, std::chrono::milliseconds limit) {
    const std::string name = "127.0.0.1:" + std::to_string(broker.port());
    return run_until([&] { return bridge_->connected() && bridge_->broker_health().broker == name; }, limit);
  }
  /// The answer to a command there.
  std::string ask(const Mosquitto& broker) {
    return output_of("mosquitto_rr -W 5 -t canopen/line3/fan1/frequency_command/set -e answers/1 -m '" +
                     std::string(kCommand) + "'" + at(broker) + "2>&1");
  }
  [[nodiscard]] std::uint64_t writes() const {
    return simulator::Record::total(drives_[0]->record().sdo_writes) + drives_[0]->record().rpdo_total();
  }
  static void expect_true(const Tree& kept, const Tree& all, const std::string& where) {
    EXPECT_FALSE(kept.contains("old/status") || kept.contains("fan1/nmt/set")) << where;
    for (const auto& [topic, payload] : all) {
      EXPECT_TRUE(kept.contains(topic)) << topic << " " << where;
    }
    for (const char* const status : {"status", "fan1/status", "fan2/status"}) {
      EXPECT_EQ(kept.at(status), "online") << where;
    }
    EXPECT_NE(kept.at("fan1/state").find("\"online\":true"), std::string::npos) << where;
  }
  static void expect_orderly_end(const Tree& kept, const std::string& where) {
    for (const char* const status : {"status", "fan1/status", "fan2/status"}) {
      EXPECT_EQ(kept.at(status), "offline") << where;
    }
    EXPECT_NE(kept.at("fan1/state").find("\"online\":false"), std::string::npos) << where;
    EXPECT_FALSE(kept.contains("fan1/output_frequency")) << where << ", emptied";
  }
  static bool is_active(const Tree& kept) {
    return kept.at("fan2/alarm/emcy").find("\"active\":true") != std::string::npos;
  }

  Mosquitto first_;
  Mosquitto second_;
  support::HandDrivenLoop loop_;
  config::Model model_;
  canopen::VirtualBus wire_{loop_.executor()};
  simulator::Network network_{loop_.executor(), wire_.connect()};
  std::vector<std::unique_ptr<simulator::Drive>> drives_;
  canopen::Bus bus_{
      loop_.executor(), wire_.connect(), {.bitrate = 1000000, .node_id = 127, .heartbeat = {}, .sync = {}}};
  std::unique_ptr<process::Plant> plant_;
  canopen::Subscription bus_state_;
  std::unique_ptr<Bridge> bridge_;
};

TEST_F(FailOver, WhateverBrokerIsInUseHoldsTheTruthAndNoCommandIsCarriedOutTwice) {
  ASSERT_TRUE(run_until([this] { return plant_->online() == 2; }, 20s));
  ASSERT_TRUE(is_in_use(first_, 20s));
  Tree all;
  for (int tries = 0; tries < 10 && !(all["fan2/status"] == "online" && all.contains("fan2/alarm/emcy")); ++tries) {
    all = tree(first_);  // until each alarm is known, too
  }
  ASSERT_TRUE(all.contains("fan2/alarm/emcy"));
  expect_true(all, all, "at the first");
  EXPECT_FALSE(is_active(all));
  const std::uint64_t before = writes();
  const std::string answer = ask(first_);
  EXPECT_NE(answer.find("\"ok\":true"), std::string::npos) << answer;
  const std::uint64_t commanded = writes();
  EXPECT_GT(commanded, before);
  EXPECT_EQ(output_of("mosquitto_pub -r -t canopen/line3/fan1/nmt/set -m stop" + at(second_) + "2>&1"), "");
  EXPECT_EQ(output_of("mosquitto_pub -r -t canopen/line3/old/status -m online" + at(second_) + "2>&1"), "");

  first_.freeze();
  drives_[1]->fault(kTripCode);
  const auto frozen = steady_clock::now();
  ASSERT_TRUE(is_in_use(second_, kFailOver));
  const auto took = std::chrono::duration_cast<std::chrono::milliseconds>(steady_clock::now() - frozen);
  std::printf("the second is in use %lld ms after the first froze\n", static_cast<long long>(took.count()));
  const Tree at_second = settled_tree(second_, all);
  expect_true(at_second, all, "at the second, without what is left there of before");
  EXPECT_TRUE(is_active(at_second));
  EXPECT_NE(at_second.at("health").find(":" + std::to_string(first_.port()) + ": the broker acknowledges nothing"),
            std::string::npos)
      << at_second.at("health");
  const std::string again = ask(second_);
  EXPECT_NE(again.find("\"code\":\"duplicate\""), std::string::npos) << again;
  EXPECT_NE(again.find("\"first\":{\"ok\":true}"), std::string::npos) << again;
  EXPECT_EQ(writes(), commanded);
  EXPECT_EQ(plant_->online(), 2U) << "what was retained there is no command";

  first_.resume();
  ASSERT_TRUE(is_in_use(first_, 20s));
  const Tree back = settled_tree(first_, all);
  expect_true(back, all, "back at the first");
  EXPECT_TRUE(is_active(back));
  const Tree left = tree(second_);
  expect_orderly_end(left, "left behind at the second");
  EXPECT_TRUE(is_active(left)) << "alarms stand as they were";
  const std::string third = ask(first_);
  EXPECT_NE(third.find("\"code\":\"duplicate\""), std::string::npos) << third;
  EXPECT_EQ(writes(), commanded);
}

}  // namespace
}  // namespace mqtt
