#include "canopen/node/motor_check.h"

#include <algorithm>
#include <array>

#include "canopen/hex.h"
#include "canopen/sdo/client.h"

namespace canopen {
namespace {

boost::asio::awaitable<Result<bool>> read_sign(SdoClient& sdo, const MotorSign& sign) {
  const Result<Raw> value = co_await sdo.read(sign.object, sign.type);
  co_return value.has_error() ? Result<bool>(value.error()) : Result<bool>(shows(sign, value.value()));
}

std::string unreadable(std::string_view what, const Error& error) {
  return std::string(what) + " cannot be read: " + to_string(error);
}

}  // namespace

bool shows(const MotorSign& sign, Raw raw) noexcept {
  if (sign.negative) {
    return to_number(sign.type, raw) < 0;
  }
  return std::find(sign.values.begin(), sign.values.end(), raw & sign.mask) != sign.values.end();
}

boost::asio::awaitable<std::optional<bool>> read_running(SdoClient& sdo, const MotorSigns& motor) {
  if (!motor.running) {
    co_return std::nullopt;
  }
  const Result<bool> running = co_await read_sign(sdo, *motor.running);
  co_return running.has_value() ? std::optional(running.value()) : std::nullopt;
}

boost::asio::awaitable<std::string> why_not_to_start(SdoClient& sdo, const MotorSigns& motor) {
  struct Against {
    const std::optional<MotorSign>& sign;
    const char* what;
    const char* shown;
  };
  const std::array against{Against{motor.fault, "its fault", "it has a fault"},
                           Against{motor.running, "whether its motor runs", "its motor runs"}};
  for (const Against& each : against) {
    if (!each.sign) {
      continue;
    }
    const Result<bool> shown = co_await read_sign(sdo, *each.sign);
    if (shown.has_error()) {
      co_return unreadable(each.what, shown.error());
    }
    if (shown.value()) {
      co_return each.shown;
    }
  }
  if (motor.control && !motor.stops.empty()) {
    const Result<Raw> value = co_await sdo.read(*motor.control, motor.control_type);
    if (value.has_error()) {
      co_return unreadable("its control command", value.error());
    }
    if (!is_stop(motor, value.value())) {
      co_return "its control command holds 0x" + hex(value.value(), 1) + ", which is no stop";
    }
  }
  co_return std::string();
}

}  // namespace canopen
