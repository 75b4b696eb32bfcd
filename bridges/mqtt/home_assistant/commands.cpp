#include "bridges/mqtt/home_assistant/commands.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "bridges/mqtt/value_text.h"

namespace mqtt::home_assistant {
namespace {

using text::ObjectText;

constexpr std::string_view kControl = "control_command";
// Home Assistant takes no smaller step.
constexpr double kSmallestStep = 0.001;

// Without a state Home Assistant would show what was asked for.
constexpr const char* kNeverKnown = "{{ None }}";

/// A value that people choose by name.
struct Choice {
  std::int64_t raw = 0;
  std::string name;
  std::string json{};  ///< As a command has it.
};

/// Also where a broker or a client repeats what was lost: QoS 1 for a stop; others are rather lost than late.
void append_way(ObjectText& object, const std::string& command_topic, int qos) {
  object.text("command_topic", command_topic);
  object.integer("qos", qos);
  object.boolean("retain", false);
}

std::string command_json(const std::string& value) {
  return "{\"value\":" + value + "}";
}

std::vector<Choice> choices_of(const config::Signal& signal) {
  if (signal.type == canopen::DataType::boolean) {
    return {{0, "false", "false"}, {1, "true", "true"}};
  }
  std::vector<Choice> choices;
  for (const auto& [raw, name] : signal.values) {
    Choice choice{.raw = raw, .name = name};
    text::append_quoted(choice.json, name);
    choices.push_back(std::move(choice));
  }
  return choices;
}

struct Limits {
  double min = 0;
  double max = 0;
};

// 32767 times 0.1 is 3276.7000000000003.
double rounded(double value, unsigned decimals) {
  const double factor = std::pow(10.0, static_cast<double>(decimals));
  return std::round(value * factor) / factor;
}

// Beyond 32 bits, and of REAL, a type says nothing of what is sensible.
std::optional<Limits> limits_of(const config::Signal& signal) {
  const unsigned bits = canopen::bit_length(signal.type);
  const bool known = !canopen::is_real(signal.type) && bits <= 32;
  if (!known && !(signal.min && signal.max)) {
    return std::nullopt;
  }
  const bool has_sign = canopen::is_signed(signal.type);
  const double least = known && has_sign ? -std::ldexp(1.0, static_cast<int>(bits) - 1) : 0.0;
  const double most = known ? std::ldexp(1.0, static_cast<int>(has_sign ? bits - 1 : bits)) - 1.0 : 0.0;
  const auto [low, high] =
      std::minmax({rounded(least * signal.scale, signal.decimals), rounded(most * signal.scale, signal.decimals)});
  const Limits limits{.min = signal.min.value_or(low), .max = signal.max.value_or(high)};
  return limits.min < limits.max ? std::optional(limits) : std::nullopt;
}

double step_of(const config::Signal& signal) {
  const double step =
      canopen::is_real(signal.type) ? std::pow(10.0, -static_cast<double>(signal.decimals)) : std::abs(signal.scale);
  return std::max(step, kSmallestStep);
}

// A word without a unit and without limits may do anything; so may the control command, whatever limits it has.
bool is_set_point(const config::Signal& signal) {
  return signal.name != kControl && signal.momentary.empty() && signal.momentary_mask == 0 &&
         (!signal.unit.empty() || (signal.min && signal.max));
}

std::string number_text(double value) {
  std::string text;
  text::append_number(text, value);
  return text;
}

// What is out of range Home Assistant would not take, and show the last value on.
std::string number_template(const config::Signal& signal, const Limits& limits) {
  const std::string value = value_of(signal.name);
  return template_of(
      value, value + " is number and " + number_text(limits.min) + " <= " + value + " <= " + number_text(limits.max));
}

void append_number_entity(std::vector<Entity>& entities, const config::Signal& signal, const std::string& topic,
                          const DriveTopics& topics) {
  const auto limits = limits_of(signal);
  if (!limits || !is_set_point(signal)) {
    return;
  }
  entities.push_back(entity_of(topics, "number", signal.name, label_of(signal.name), [&](ObjectText& object) {
    const bool readable = config::readable(signal.access);
    object.text("value_template", readable ? number_template(signal, *limits) : kNeverKnown);
    append_way(object, topic, 0);
    object.number("min", limits->min);
    object.number("max", limits->max);
    object.number("step", step_of(signal));
    object.text("mode", "box");  // nobody touches a box by mistake, as a slider
    if (!signal.unit.empty()) {
      append_unit(object, signal.unit);
    }
  }));
}

std::string choice_template(const config::Signal& signal, const std::string& codes) {
  if (!config::readable(signal.access)) {
    return kNeverKnown;
  }
  return signal.type == canopen::DataType::boolean
             ? "{{ " + value_of(signal.name) + " | lower }}"
             : template_of(value_of(signal.name), code_is_among(signal.name, codes));
}

void append_select(std::vector<Entity>& entities, const config::Signal& signal, const std::vector<Choice>& choices,
                   const std::string& topic, const DriveTopics& topics) {
  entities.push_back(entity_of(topics, "select", signal.name, label_of(signal.name), [&](ObjectText& object) {
    std::string codes;
    for (const Choice& choice : choices) {
      codes += (codes.empty() ? "" : ", ") + std::to_string(choice.raw);
    }
    object.text("value_template", choice_template(signal, codes));
    append_way(object, topic, 0);
    // As JSON, so that no name is taken for a number or for JSON.
    object.text("command_template", signal.type == canopen::DataType::boolean
                                        ? "{{ {'value': value == 'true'} | tojson }}"
                                        : "{{ {'value': value} | tojson }}");
    if (signal.name == kControl) {
      object.boolean("enabled_by_default", false);  // one touch of the first page there would start a motor
    }
    text::append_list(object.key("options"), choices,
                      [](std::string& list, const Choice& choice) { text::append_quoted(list, choice.name); });
  }));
}

void append_button(std::vector<Entity>& entities, const config::Signal& signal, const Choice& choice,
                   const std::string& topic, const DriveTopics& topics) {
  const std::string name = signal.name + "_" + std::to_string(choice.raw);
  entities.push_back(
      entity_of(topics, "button", name, label_of(signal.name) + ": " + choice.name, [&](ObjectText& object) {
        append_way(object, topic, 0);
        object.text("payload_press", command_json(choice.json));
        object.boolean("enabled_by_default", false);  // it may be a jog, which nobody ends by letting go
      }));
}

// Of the control command, by its name where it has one.
void append_stop(std::vector<Entity>& entities, const config::Drive& drive, const std::string& topic,
                 const config::Signal& signal, const DriveTopics& topics) {
  const auto stop = canopen::first_stop(drive.node.motor);
  if (!stop) {
    return;
  }
  const auto named = signal.values.find(static_cast<std::int64_t>(*stop));
  std::string value;
  if (named != signal.values.end()) {
    text::append_quoted(value, named->second);
  } else {
    value = integer_text(signal.type, *stop);
  }
  entities.push_back(entity_of(topics, "button", "stop", "Stop", [&](ObjectText& object) {
    append_way(object, topic, 1);
    object.text("payload_press", command_json(value));
  }));
}

}  // namespace

void append_commands(std::vector<Entity>& entities, const config::Drive& drive, const DriveTopics& topics) {
  for (std::size_t i = 0; i < drive.signals.size(); ++i) {
    const config::Signal& signal = drive.signals[i];
    if (!config::writable(signal.access)) {
      continue;
    }
    const std::string topic = topics.signals.at(i) + "/set";
    if (signal.name == kControl) {
      append_stop(entities, drive, topic, signal, topics);
    }
    const std::vector<Choice> choices = choices_of(signal);
    if (choices.empty()) {
      append_number_entity(entities, signal, topic, topics);
      continue;
    }
    std::vector<Choice> lasting;
    for (const Choice& choice : choices) {
      if (config::is_momentary(signal, static_cast<canopen::Raw>(choice.raw))) {
        append_button(entities, signal, choice, topic, topics);
      } else {
        lasting.push_back(choice);
      }
    }
    if (!lasting.empty()) {
      append_select(entities, signal, lasting, topic, topics);
    }
  }
}

}  // namespace mqtt::home_assistant
