#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt {

/// Message expiry of what says that the gateway lives, in seconds; 0: none.
[[nodiscard]] constexpr std::uint32_t expiry_of(const config::Mqtt& settings) noexcept {
  return static_cast<std::uint32_t>(std::chrono::ceil<std::chrono::seconds>(settings.expiry).count());
}

/// How often such a topic is published at least, so that it never expires while the gateway lives.
[[nodiscard]] constexpr canopen::Duration refresh_interval(const config::Mqtt& settings) noexcept {
  return settings.expiry == canopen::Duration::zero() ? settings.max_interval
                                                      : std::min(settings.max_interval, settings.expiry / 3);
}

/// A gateway of which nothing was heard for so long is gone. What lives for ever says nothing; three intervals do then.
[[nodiscard]] constexpr canopen::Duration lifetime(const config::Mqtt& settings) noexcept {
  return settings.expiry == canopen::Duration::zero()
             ? std::max<canopen::Duration>(std::chrono::seconds(180), 3 * settings.max_interval)
             : settings.expiry;
}

}  // namespace mqtt
