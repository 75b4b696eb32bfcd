#include "bridges/mqtt/home_assistant/entity.h"

#include <algorithm>
#include <array>

namespace mqtt::home_assistant {
namespace {

struct UnitClass {
  std::string_view unit;
  std::string_view device_class;
};

// Not %, which Home Assistant knows as humidity, battery or power factor, and not K, which may be a difference. What is
// not here (rpm, Nm) is shown with its unit and without a class.
constexpr std::array<UnitClass, 20> kUnitClasses{{
    {"Hz", "frequency"}, {"kHz", "frequency"},  {"A", "current"},      {"mA", "current"},  {"V", "voltage"},
    {"mV", "voltage"},   {"W", "power"},        {"kW", "power"},       {"Wh", "energy"},   {"kWh", "energy"},
    {"MWh", "energy"},   {"°C", "temperature"}, {"°F", "temperature"}, {"s", "duration"},  {"min", "duration"},
    {"h", "duration"},   {"bar", "pressure"},   {"mbar", "pressure"},  {"Pa", "pressure"}, {"kPa", "pressure"},
}};

std::string_view device_class_of(std::string_view unit) noexcept {
  const auto* const known = std::ranges::find(kUnitClasses, unit, &UnitClass::unit);
  return known == kUnitClasses.end() ? std::string_view() : known->device_class;
}

}  // namespace

std::string label_of(std::string_view signal) {
  std::string label(signal);
  std::ranges::replace(label, '_', ' ');
  if (!label.empty() && label.front() >= 'a' && label.front() <= 'z') {
    label.front() = static_cast<char>(label.front() - 'a' + 'A');
  }
  return label;
}

std::string value_of(std::string_view signal) {
  return std::string("value_json['values']['").append(signal).append("']");
}

std::string template_of(const std::string& value, const std::string& condition) {
  return "{{ " + value + " if " + condition + " else None }}";
}

std::string code_is_among(std::string_view signal, const std::string& codes) {
  return value_of(std::string(signal) + "_code") + " in [" + codes + "]";
}

bool is_energy(std::string_view unit) noexcept {
  return device_class_of(unit) == "energy";
}

void append_unit(text::ObjectText& object, const std::string& unit) {
  object.text("unit_of_measurement", unit);
  if (const std::string_view device_class = device_class_of(unit); !device_class.empty()) {
    object.text("device_class", device_class);
  }
}

}  // namespace mqtt::home_assistant
