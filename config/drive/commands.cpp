#include <algorithm>

#include "config/drive/builder.h"
#include "config/schema/complaint.h"
#include "config/schema/nearest.h"
#include "config/text.h"
#include "config/toml/document.h"
#include "config/value_check.h"

namespace config {
namespace {

using canopen::Duration;
using canopen::Raw;

/// `0x0005, 0x0006`: the exact values that only stop.
std::string known_stops(const canopen::MotorSigns& motor) {
  if (motor.stops.empty()) {
    return "no stop of this drive is known";
  }
  std::string all;
  bool masks = false;
  const Raw width = ~Raw{0} >> (64U - canopen::bit_length(motor.control_type));
  for (const canopen::StopWord& stop : motor.stops) {
    masks = masks || stop.mask != width;
    all += stop.mask == width ? (all.empty() ? "stops are " : ", ") + to_hex(stop.equals) : "";
  }
  return all + (masks ? std::string(all.empty() ? "stops are" : " and") + " those of its stop_masks" : "");
}

/// The `values` of a timeout, each checked as a command is.
class TimeoutValues {
 public:
  TimeoutValues(DriveDraft& draft, const Node& table) : draft_(draft), table_(table) {}

  void take() {
    for (const Entry& entry : table_.entries) {
      if (const auto value = value_of(entry); value.has_value()) {
        draft_.drive.commands.timeout_values.push_back(*value);
      }
    }
    const auto control = draft_.drive.find("control_command");
    auto& values = draft_.drive.commands.timeout_values;
    const auto stop = std::ranges::find(values, control, &TimeoutValue::signal);
    if (stop != values.end()) {
      std::rotate(values.begin(), stop, stop + 1);
    }
  }

 private:
  void error(Place place, const Entry& entry, const std::string& text) const {
    draft_.error(place, "commands.values." + entry.key + " " + text);
  }

  [[nodiscard]] std::optional<TimeoutValue> value_of(const Entry& entry) const {
    const auto position = draft_.drive.find(entry.key);
    if (!position.has_value()) {
      explain_unknown(entry);
      return std::nullopt;
    }
    const Signal& signal = draft_.drive.signals[*position];
    if (!writable(signal.access)) {
      error(entry.key_place, entry, "cannot be written");
      return std::nullopt;
    }
    const auto raw = raw_of(signal, entry);
    if (!raw.has_value() || !may_be_written(signal, *raw, entry)) {
      return std::nullopt;
    }
    return TimeoutValue{.signal = *position, .raw = *raw};
  }

  void explain_unknown(const Entry& entry) const {
    std::vector<std::string_view> names;
    for (const Signal& signal : draft_.drive.signals) {
      if (writable(signal.access)) {
        names.emplace_back(signal.name);
      }
    }
    error(entry.key_place, entry, "is no signal of this drive; " + nearest_or_all(entry.key, names));
  }

  [[nodiscard]] std::optional<Raw> raw_of(const Signal& signal, const Entry& entry) const {
    const Node& value = entry.value;
    const bool boolean = signal.type == canopen::DataType::boolean;
    switch (value.kind) {
      case NodeKind::boolean:
        if (!boolean) {
          error(value.place, entry, "takes a number, not true or false");
          return std::nullopt;
        }
        return Raw{value.boolean ? 1U : 0U};
      case NodeKind::text:
        return named(signal, entry);
      case NodeKind::integer: {
        // Exact, where a double would not be.
        const bool exact = signal.scale == 1.0 && !canopen::is_real(signal.type) &&
                           (value.integer >= 0 || canopen::is_signed(signal.type));
        return exact ? checked(signal, entry, static_cast<Raw>(value.integer))
                     : checked(signal, entry, static_cast<double>(value.integer));
      }
      case NodeKind::number:
        return checked(signal, entry, value.number);
      default:
        return std::nullopt;  // it has its finding
    }
  }

  [[nodiscard]] std::optional<Raw> named(const Signal& signal, const Entry& entry) const {
    std::vector<std::string_view> names;
    for (const auto& [number, name] : signal.values) {
      if (name == entry.value.text) {
        return canopen::normalise(signal.type, static_cast<Raw>(number));
      }
      names.emplace_back(name);
    }
    error(entry.value.place, entry,
          names.empty() ? "takes a number; it has no names for its values"
                        : in_quotes(entry.value.text) + " is not known; " + nearest_or_all(entry.value.text, names));
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Raw> checked(const Signal& signal, const Entry& entry,
                                           std::variant<Raw, double> value) const {
    const auto raw = check_value(signal, value);
    if (raw.has_error()) {
      error(entry.value.place, entry, "is " + raw.error().detail);
      return std::nullopt;
    }
    return raw.value();
  }

  /// A timeout writes again until it is confirmed, and nobody watches it.
  [[nodiscard]] bool may_be_written(const Signal& signal, Raw raw, const Entry& entry) const {
    const canopen::MotorSigns& motor = draft_.drive.node.motor;
    if (signal.name == "control_command" && !canopen::is_stop(motor, raw)) {
      error(entry.value.place, entry, "must be a value that only ever stops; " + known_stops(motor));
      return false;
    }
    if (is_momentary(signal, raw)) {
      error(entry.value.place, entry, "must be no momentary value, which acts each time it is written");
      return false;
    }
    return true;
  }

  DriveDraft& draft_;
  const Node& table_;
};

void take_timeout(DriveDraft& draft, const Node& commands) {
  const Commands& keys = draft.drive.commands;
  const Node* const values = read_table(commands, "values");
  if (values != nullptr) {
    TimeoutValues(draft, *values).take();
  }
  const bool any = values != nullptr && !values->entries.empty();
  const bool misshapen = values == nullptr && commands.find("values") != nullptr;  // it has its finding
  if (keys.on_timeout == OnTimeout::values && !any && !misshapen) {
    draft.error(command_place(draft, "on_timeout"),
                "commands.on_timeout = \"values\" needs values to write, such as values = { control_command = 5 }");
  } else if (keys.on_timeout != OnTimeout::values && any) {
    draft.warning(command_place(draft, "values"),
                  "commands.values are never written; on_timeout = \"values\" would write them");
  }
  if (keys.on_timeout == OnTimeout::cease && !supervised_rpdo(draft).has_value()) {
    draft.error(
        command_place(draft, "on_timeout"),
        "commands.on_timeout = \"cease\" stops nothing where the drive supervises no RPDO: an RPDO that is sent "
        "needs event_timer and supervised = true; use \"values\"");
  }
  if (keys.on_timeout != OnTimeout::hold && keys.timeout == Duration::zero()) {
    draft.warning(command_place(draft, "on_timeout"), "commands.on_timeout never acts without timeout; set timeout");
  }
}

void check_feedback(const DriveDraft& draft) {
  if (draft.drive.commands.feedback == Duration::zero()) {
    return;
  }
  const canopen::MotorSigns& motor = draft.drive.node.motor;
  std::string missing = motor.running.has_value() ? "" : "a signal \"running\"";
  if (motor.stops.empty()) {
    missing += (missing.empty() ? "" : " and ") + std::string("stop values of control_command");
  }
  if (!missing.empty()) {
    draft.error(command_place(draft, "feedback"), "commands.feedback needs " + missing);
  }
}

}  // namespace

Place command_place(const DriveDraft& draft, std::string_view key) {
  const Node* const commands = read_table(draft.site, "commands");
  const bool stated = commands != nullptr && commands->find(key) != nullptr;
  return stated ? place_of(*commands, key) : draft.site.place;
}

void take_commands(DriveDraft& draft) {
  if (const Node* const commands = read_table(draft.site, "commands"); commands != nullptr) {
    take_timeout(draft, *commands);
    check_feedback(draft);
  }
}

}  // namespace config
