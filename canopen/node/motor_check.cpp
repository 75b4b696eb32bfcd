#include "canopen/node/motor_check.h"

#include <algorithm>

#include "canopen/hex.h"
#include "canopen/sdo/client.h"

namespace canopen {
namespace {

bool is_negative(DataType type, Raw raw) noexcept {
  const auto bits = static_cast<unsigned>(8 * byte_length(type));
  return ((raw >> (bits - 1)) & 1U) != 0;
}

std::string unreadable(std::string_view what, const Error& error) {
  return std::string(what) + " cannot be read: " + to_string(error);
}

}  // namespace

bool shows(const MotorSign& sign, Raw raw) noexcept {
  if (sign.negative) {
    return is_negative(sign.type, raw);
  }
  return std::find(sign.values.begin(), sign.values.end(), raw & sign.mask) != sign.values.end();
}

bool is_stop(const MotorSigns& motor, Raw control) noexcept {
  return std::any_of(motor.stops.begin(), motor.stops.end(),
                     [&](const StopWord& stop) { return (control & stop.mask) == stop.equals; });
}

boost::asio::awaitable<std::optional<bool>> read_running(SdoClient& sdo, const MotorSigns& motor) {
  std::optional<bool> running;
  if (motor.running) {
    const Result<Raw> value = co_await sdo.read(motor.running->object, motor.running->type);
    if (value.has_value()) {
      running = shows(*motor.running, value.value());
    }
  }
  co_return running;
}

boost::asio::awaitable<std::string> why_not_to_start(SdoClient& sdo, const MotorSigns& motor) {
  if (motor.fault) {
    const Result<Raw> value = co_await sdo.read(motor.fault->object, motor.fault->type);
    if (value.has_error()) {
      co_return unreadable("its fault", value.error());
    }
    if (shows(*motor.fault, value.value())) {
      co_return "it has a fault";
    }
  }
  if (motor.running) {
    const Result<Raw> value = co_await sdo.read(motor.running->object, motor.running->type);
    if (value.has_error()) {
      co_return unreadable("whether its motor runs", value.error());
    }
    if (shows(*motor.running, value.value())) {
      co_return "its motor runs";
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
