#pragma once

#include <chrono>

#include "bridges/mqtt/attempts.h"
#include "bridges/mqtt/client.h"
#include "config/model.h"

namespace mqtt {

/// How the publisher behaves; the defaults are for real plants.
struct PublisherSettings {
  config::Endpoint broker;
  ClientSettings client;  ///< Its uri and version are filled in per attempt.
  int version = 0;        ///< 5 or 4 (MQTT 3.1.1) only; 0: 5, and 3.1.1 with brokers that do not speak it.
  std::chrono::milliseconds first_pause{1000};
  std::chrono::milliseconds longest_pause{5000};
  std::chrono::milliseconds pause_after_refusal{60000};  ///< Of credentials, and after a take-over of our client id.
  std::chrono::milliseconds farewell{2000};              ///< For the last messages at the end.
  std::chrono::milliseconds resolve_patience{300000};    ///< A publisher that resolves longer stands still.
  Resolver resolver = resolve;
};

/// As a site configured it. The client id is `canopen-gateway-<name>` where it names none.
[[nodiscard]] PublisherSettings publisher_settings(const config::Mqtt& mqtt, const config::Gateway& gateway);

}  // namespace mqtt
