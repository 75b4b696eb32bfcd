// What a broker keeps on the topics that tell Home Assistant of drives, and in
// B/home_assistant: whatever the bytes, what is told
// of the drives stays what they are, and JSON.

#include <algorithm>
#include <boost/json/parse.hpp>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/mqtt/home_assistant/discovery.h"
#include "bridges/mqtt/home_assistant/entity.h"
#include "tests/unit/mqtt/site.h"

namespace {

using mqtt::home_assistant::Discovery;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

const config::Model& site() {
  static const config::Model model = [] {
    config::Model made = mqtt::test::model();
    made.mqtt->home_assistant = "homeassistant";
    return made;
  }();
  return model;
}

void keep(const std::string& topic, const std::string& payload) {
  const config::Mqtt& settings = *site().mqtt;
  static const mqtt::Topics topics(site(), settings, "line3");
  mqtt::Leftovers leftovers(site(), settings, topics);
  Discovery discovery(site(), settings, topics, leftovers, "1");
  const canopen::TimePoint now{std::chrono::hours(1)};
  discovery.prefixes_kept(payload);
  for (const mqtt::Subscription& each : discovery.subscriptions()) {
    require(!mqtt::matches(each.filter, "canopen/line3/pump1/set"));
  }
  require(discovery.heard({.topic = topic, .payload = payload, .retained = true}, now));
  discovery.announced(now);
  std::vector<mqtt::Message> out;
  discovery.collect(false, now + Discovery::kPause, out);
  require(out.size() == 2);
  boost::json::error_code failure;
  const boost::json::value told = boost::json::parse(out[1].payload, failure);
  require(!failure);
  // Twice the same key would be one here.
  std::size_t keys = 0;
  for (const auto& [key, value] : told.at("components").as_object()) {
    const std::string platform(value.at("platform").as_string());
    require(std::string_view(key.data(), key.size()).starts_with(platform + "_"));
    require(std::ranges::find(mqtt::home_assistant::kPlatforms, platform) != mqtt::home_assistant::kPlatforms.end());
    keys += value.as_object().size() > 1 ? 1U : 0U;
  }
  const auto device = mqtt::home_assistant::device_of(site().drives[0], topics, 0, settings, "1", {});
  require(keys == device.entities.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  keep("homeassistant/device/canopen_line3/pump1/config", text);
  keep("homeassistant/device/canopen_line3/gone/config", text);
  return 0;
}
