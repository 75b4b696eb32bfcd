#include "daemon/map_text.h"

#include <cmath>

#include "config/address_map.h"

namespace gateway {
namespace {

std::string topic_of(const config::Model& model, const config::Drive& drive, const config::Signal& signal) {
  return base_topic(model) + "/" + drive.name + "/" + signal.name;
}

}  // namespace

std::string base_topic(const config::Model& model) {
  return (model.mqtt.has_value() ? model.mqtt->base : config::Mqtt().base) + "/" + model.gateway.name;
}

std::optional<std::string> value_topic(const config::Model& model, const config::Drive& drive,
                                       const config::Signal& signal) {
  const bool published = !model.mqtt.has_value() || model.mqtt->signals;
  return readable(signal.access) && published ? std::optional(topic_of(model, drive, signal)) : std::nullopt;
}

std::optional<std::string> set_topic(const config::Model& model, const config::Drive& drive,
                                     const config::Signal& signal) {
  return writable(signal.access) ? std::optional(topic_of(model, drive, signal) + "/set") : std::nullopt;
}

std::optional<config::ModbusPlace> modbus_place(const config::Drive& drive, const config::Signal& signal) {
  const bool mapped = (drive.unit || drive.flat) && signal.modbus.kind != config::ModbusKind::none;
  return mapped ? std::optional(signal.modbus) : std::nullopt;
}

std::optional<std::uint16_t> flat_address(const config::Model& model, const config::Drive& drive,
                                          const config::Signal& signal) {
  const bool has_unit = model.modbus && model.modbus->flat_unit;
  const bool there = signal.modbus.kind != config::ModbusKind::none &&
                     signal.modbus.address + signal.modbus.count <= config::kFlatSignals;
  return has_unit && drive.flat && there
             ? std::optional(static_cast<std::uint16_t>(*drive.flat + signal.modbus.address))
             : std::nullopt;
}

double percent(double share) noexcept {
  return std::round(share * 1000.0) / 10.0;
}

}  // namespace gateway
