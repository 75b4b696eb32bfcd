#pragma once

#include <mqtt/async_client.h>

#include "bridges/mqtt/client.h"

namespace mqtt {

/// How Paho connects.
[[nodiscard]] connect_options options_of(const ClientSettings& settings);
/// How it subscribes, of MQTT 5.
[[nodiscard]] subscribe_options options_of(const Subscription& subscription);
/// How a client of it is made.
[[nodiscard]] create_options creation_of(const ClientSettings& settings);

}  // namespace mqtt
