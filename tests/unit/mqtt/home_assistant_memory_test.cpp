// What is known of before when the program starts anew: by what the broker keeps, of which it sends no message that is
// longer than what a client takes.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/bridge.h"
#include "bridges/mqtt/home_assistant/discovery.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using home_assistant::Discovery;
using home_assistant::Prefixes;
using test::PlantSite;

using Kept = std::map<std::string, std::string>;

// As the publisher's CONNECT says; a broker sends nothing longer (MQTT 5, 3.1.2.11.4).
constexpr std::size_t kLongestSent = 128UL * 1024;
constexpr std::size_t kMany = 100;
constexpr const char* kPrefixMemory = "canopen/line3/home_assistant";
constexpr const char* kStatusOfTree = "canopen/line3/status";

config::Model site_of(std::size_t drives, std::string prefix) {
  config::Model model = PlantSite::bridge_model();
  model.mqtt->home_assistant = std::move(prefix);
  for (std::size_t i = 1; i < drives; ++i) {
    config::Drive drive = model.drives[0];
    drive.name = "drive" + std::to_string(i);
    drive.node.node = static_cast<std::uint8_t>(5 + i);
    drive.unit = drive.node.node;
    drive.enabled = false;
    model.drives.push_back(std::move(drive));
  }
  return model;
}

void send_kept(PlantSite& site, const Kept& kept, const std::string& filter) {
  for (const auto& [topic, payload] : kept) {
    if (matches(filter, topic) && topic.size() + payload.size() < kLongestSent) {
      site.receive({.topic = topic, .payload = payload, .retained = true});
    }
  }
}

/// A life of the program at a broker that keeps this, and what it keeps behind it. Without `orderly` it ends as by a
/// power failure.
Kept live(const Kept& kept, std::size_t drives, const std::string& prefix, canopen::Duration time, bool orderly = true,
          const std::string& refused = {}) {
  PlantSite site(site_of(drives, prefix));
  site.broker().retained = kept;
  std::erase_if(site.broker().retained, [](const auto& each) { return each.second.empty(); });
  const Kept before = site.broker().retained;
  site.broker().events->on_connected({.id = 1, .broker = "10.0.0.1:1883"});
  site.loop().settle();
  site.broker().unanswered.clear();
  site.broker().events->on_subscribed({.filter = "canopen/line3/#"});
  send_kept(site, before, "canopen/line3/#");
  site.run(Session::kQuiet + 100ms);
  site.broker().events->on_unsubscribed("canopen/line3/#");
  site.loop().settle();
  site.broker().answer_subscriptions("Not authorized (0x87)", refused.empty() ? "none of them" : refused);
  site.loop().settle();
  for (const Subscription& each : site.broker().subscribed) {
    if (each.kept && each.filter != refused) {
      send_kept(site, before, each.filter);
    }
  }
  site.run(time);
  Kept after = site.broker().retained;
  std::erase_if(after, [](const auto& each) { return each.second.empty(); });
  if (orderly) {
    after[kStatusOfTree] = "offline";
  }
  return after;
}

std::size_t devices(const Kept& kept, const std::string& prefix) {
  return static_cast<std::size_t>(std::ranges::count_if(
      kept, [&](const auto& each) { return matches(prefix + "/device/+/+/config", each.first); }));
}

TEST(MqttHomeAssistantMemory, SwitchedOffAllOfALargeSiteIsEmptied) {
  const Kept on = live({}, kMany, "homeassistant", 5s);
  EXPECT_EQ(devices(on, "homeassistant"), kMany);
  EXPECT_GT(on.at("canopen/line3/info").size(), kLongestSent) << "else a smaller site is tried than there are";
  const Kept off = live(on, kMany, "", 5s);
  EXPECT_EQ(devices(off, "homeassistant"), 0U);
}

TEST(MqttHomeAssistantMemory, AnotherPrefixLeavesNothingOfALargeSiteBelowTheOldOne) {
  const Kept other = live(live({}, kMany, "homeassistant", 5s), kMany, "home", 5s);
  EXPECT_EQ(devices(other, "homeassistant"), 0U);
  EXPECT_EQ(devices(other, "home"), kMany);
}

TEST(MqttHomeAssistantMemory, APrefixIsKnownUntilAConnectionShowsNothingBelowIt) {
  const Kept on = live({}, 1, "homeassistant", 5s);
  EXPECT_EQ(on.at(kPrefixMemory), R"({"prefixes":["homeassistant"]})");
  const Kept off = live(on, 1, "", Prefixes::kPatience + 1s);
  EXPECT_EQ(devices(off, "homeassistant"), 0U);
  EXPECT_EQ(off.at(kPrefixMemory), R"({"prefixes":["homeassistant"]})") << "nobody saw yet that it worked";
  const Kept seen = live(off, 1, "", Prefixes::kPatience + 1s);
  EXPECT_FALSE(seen.contains(kPrefixMemory));
}

TEST(MqttHomeAssistantMemory, LivesThatEndBeforeItWasEmptiedForgetNothing) {
  Kept kept = live({}, 2, "homeassistant", 5s, false);
  for (const char* prefix : {"home", "haus", "home"}) {
    kept = live(kept, 2, prefix, 20s, false);
    EXPECT_EQ(devices(kept, "homeassistant"), 2U) << "another gateway may live";
  }
  EXPECT_EQ(kept.at(kPrefixMemory), R"({"prefixes":["home","homeassistant"]})")
      << "below haus there was never anything";
  kept = live(kept, 2, "", 70s, false);
  EXPECT_EQ(devices(kept, "homeassistant") + devices(kept, "home") + devices(kept, "haus"), 0U);
}

TEST(MqttHomeAssistantMemory, WhatMayNotBeReadIsNotTakenForEmpty) {
  const Kept on = live({}, 1, "homeassistant", 5s);
  const Kept off = live(on, 1, "", 20s, true, "homeassistant/device/canopen_line3/+/config");
  EXPECT_EQ(devices(off, "homeassistant"), 1U);
  EXPECT_EQ(off.at(kPrefixMemory), R"({"prefixes":["homeassistant"]})");
  EXPECT_EQ(devices(live(off, 1, "", 5s), "homeassistant"), 0U) << "where it may be";
}

TEST(MqttHomeAssistantMemory, WhereItWasNeverOnNothingIsKept) {
  EXPECT_FALSE(live({}, 1, "", 20s).contains(kPrefixMemory));
}

}  // namespace
}  // namespace mqtt
