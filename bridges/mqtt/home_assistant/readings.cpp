#include "bridges/mqtt/home_assistant/readings.h"

#include <array>
#include <chrono>
#include <string>
#include <string_view>

#include "bridges/mqtt/expiry.h"
#include "bridges/mqtt/value_text.h"
#include "bridges/process/drive.h"

namespace mqtt::home_assistant {
namespace {

using text::ObjectText;

void append_options(ObjectText& object, const auto& names) {
  object.text("device_class", "enum");
  text::append_list(object.key("options"), names,
                    [](std::string& list, std::string_view name) { text::append_quoted(list, name); });
}

// What is on and off is how the language of the templates writes true and false.
void append_boolean(ObjectText& object, const config::Drive& drive, std::size_t signal) {
  object.text("value_template", "{{ " + value_of(drive.signals[signal].name) + " }}");
  object.text("payload_on", "True");
  object.text("payload_off", "False");
  if (drive.faults.running == signal) {
    object.text("device_class", "running");
  } else if (drive.faults.fault == signal || drive.faults.warning == signal) {
    object.text("device_class", "problem");
  }
}

// Of what is no option Home Assistant would keep the last one that was.
void append_name(ObjectText& object, const config::Signal& signal) {
  std::string codes;
  std::vector<std::string_view> names;
  for (const auto& [raw, name] : signal.values) {
    codes += (codes.empty() ? "" : ", ") + std::to_string(raw);
    names.emplace_back(name);
  }
  object.text("value_template", template_of(value_of(signal.name), code_is_among(signal.name, codes)));
  append_options(object, names);
}

// A number without a unit may be a word of bits, or a code: there is no line to draw through it.
void append_quantity(ObjectText& object, const config::Signal& signal) {
  object.text("value_template", "{{ " + value_of(signal.name) + " }}");
  if (signal.unit.empty()) {
    object.text("entity_category", "diagnostic");
    return;
  }
  append_unit(object, signal.unit);
  // Energy may be no measurement there, but a counter only, and nobody said that this one is.
  if (!is_energy(signal.unit)) {
    object.text("state_class", "measurement");
  }
  if (!canopen::is_real(signal.type) || signal.decimals > 0) {
    object.integer("suggested_display_precision", signal.decimals);
  }
}

void append_nmt(ObjectText& object) {
  using canopen::NmtState;
  constexpr std::array kStates{NmtState::initialising, NmtState::pre_operational, NmtState::operational,
                               NmtState::stopped};
  std::vector<std::string_view> names;
  for (const NmtState state : kStates) {
    names.push_back(canopen::name_of(state));
  }
  object.text("value_template", template_of("value_json['nmt']", "value_json['nmt'] != 'unknown'"));
  append_options(object, names);
  object.text("entity_category", "diagnostic");
}

void append_reading(ObjectText& object, const config::Drive& drive, std::size_t signal, Shape shape) {
  switch (shape) {
    case Shape::boolean:
      append_boolean(object, drive, signal);
      break;
    case Shape::name:
      append_name(object, drive.signals[signal]);
      break;
    case Shape::number:
      append_quantity(object, drive.signals[signal]);
      break;
  }
}

}  // namespace

void append_readings(std::vector<Entity>& entities, const config::Drive& drive, const DriveTopics& topics,
                     const config::Mqtt& settings) {
  const auto expire_after = std::chrono::ceil<std::chrono::seconds>(lifetime(settings)).count();
  for (std::size_t i = 0; i < drive.signals.size(); ++i) {
    const config::Signal& signal = drive.signals[i];
    if (!config::readable(signal.access)) {
      continue;
    }
    const Shape shape = shape_of(drive, static_cast<process::SignalId>(i));
    const char* const platform = shape == Shape::boolean ? "binary_sensor" : "sensor";
    entities.push_back(entity_of(topics, platform, signal.name, label_of(signal.name), [&](ObjectText& object) {
      append_reading(object, drive, i, shape);
      object.integer("expire_after", expire_after);
    }));
  }
  entities.push_back(entity_of(topics, "sensor", "nmt", "NMT state", [&](ObjectText& object) {
    append_nmt(object);
    object.integer("expire_after", expire_after);
  }));
}

}  // namespace mqtt::home_assistant
