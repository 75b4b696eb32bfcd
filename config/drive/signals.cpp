#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "config/drive/builder.h"
#include "config/schema/complaint.h"
#include "config/schema/nearest.h"
#include "config/text.h"
#include "config/toml/document.h"

namespace config {
namespace {

// Fixed topics beside the signals of a drive, and the key of a command's identifier.
constexpr std::array<std::string_view, 10> kReservedSignals{"state", "status",  "alarm",   "nmt",   "sdo",
                                                            "set",   "control", "history", "drift", "id"};

/// As many decimals as show every step: 0.01 has 2, 0.25 has 2, 10 has none.
unsigned decimals_of(double scale) {
  constexpr unsigned kMost = 9;
  double steps = scale;
  for (unsigned decimals = 0; decimals < kMost; ++decimals) {
    if (std::abs(steps - std::round(steps)) <= 1e-9 * std::max(1.0, std::abs(steps)) && std::round(steps) != 0.0) {
      return decimals;
    }
    steps *= 10.0;
  }
  return kMost;
}

class SignalTaker {
 public:
  SignalTaker(DriveDraft& draft, const Said<SignalKeys>& said)
      : draft_(draft), said_(said), keys_(said.keys), signal_(said.keys.signal) {
    signal_.name = said.name;
  }

  /// Nothing where the signal is not enabled, or cannot be understood.
  std::optional<SignalDraft> take() {
    if (!keys_.enabled) {
      if (!states("object") && !states("from")) {
        explain_unknown();  // a misspelt one would go on
      }
      return std::nullopt;
    }
    if (std::find(kReservedSignals.begin(), kReservedSignals.end(), said_.name) != kReservedSignals.end()) {
      error("", "cannot be called that: the name is that of a fixed topic");
    }
    if (!(states("from") ? take_derived() : take_word())) {
      return std::nullopt;
    }
    return SignalDraft{.said = &said_, .signal = std::move(signal_)};
  }

 private:
  [[nodiscard]] bool states(std::string_view key) const { return said_.table->find(key) != nullptr; }
  void error(std::string_view key, const std::string& text) {
    draft_.error(place_of(said_, key, {"from", "object", "access", "type", "scale"}),
                 "signal \"" + said_.name + "\" " + text);
  }

  void refuse(std::initializer_list<std::string_view> keys, std::string_view why) {
    for (const std::string_view key : keys) {
      if (states(key)) {
        error(key, "has " + std::string(key) + ", which " + std::string(why) + "; leave it out");
      }
    }
  }

  bool take_derived() {
    refuse({"object", "type", "scale", "source", "min", "max", "values", "momentary", "momentary_mask", "stop",
            "stop_masks", "edge", "pdo_only", "as", "poll", "unit", "deadband", "publish_mask"},
           "has no meaning beside from");
    if (signal_.access != Access::read) {
      error("access", "is read out of another one and cannot be written");
    }
    if (keys_.negative == states("mask")) {
      draft_.error(place_of(said_, "from", {"negative", "mask"}),
                   "signal \"" + said_.name + "\" needs either mask or negative = true");
      return false;
    }
    if (keys_.negative && states("equals")) {
      error("equals", "equals has no meaning beside negative");
    }
    Derived derived;
    derived.mask = static_cast<std::uint64_t>(keys_.mask.value_or(0));
    derived.negative = keys_.negative;
    for (const std::int64_t value : keys_.equals) {
      derived.values.push_back(static_cast<std::uint64_t>(value));
      if ((derived.values.back() & ~derived.mask) != 0) {
        error("equals", "can never equal " + to_hex(derived.values.back()) + " under its mask");
      }
    }
    if (derived.values.empty() && !derived.negative) {
      derived.values.push_back(derived.mask);
    }
    signal_.type = canopen::DataType::boolean;
    signal_.derived = std::move(derived);
    return keys_.from.has_value();
  }

  bool take_word() {
    if (!keys_.object.has_value() || !keys_.type.has_value()) {
      if (!states("object") && !states("type")) {
        explain_unknown();
      } else if (!states("object") || !states("type")) {
        error("", std::string("has no ") + (states("type") ? "object" : "type") + "; a signal of your own needs both");
      }
      return false;
    }
    refuse({"mask", "equals", "negative"}, "has no meaning without from");
    signal_.object = *keys_.object;
    signal_.type = *keys_.type;
    take_scale();
    take_values();
    take_momentary();
    take_stops();
    take_limits();
    return true;
  }

  /// A name that profile and presets do not have is mostly a typing mistake.
  void explain_unknown() {
    std::vector<std::string_view> names;
    for (const Said<SignalKeys>& other : draft_.said.signals) {
      if (other.keys.object.has_value() || other.keys.from.has_value()) {
        names.emplace_back(other.name);
      }
    }
    const auto near = nearest(said_.name, names);
    draft_.error(said_.place, "signal \"" + said_.name + "\" is not in profile \"" + draft_.drive.profile + "\"" +
                                  (near.empty() ? "" : ", where " + in_quotes(near) + " is nearest") +
                                  "; a signal of your own needs object and type");
  }

  void take_scale() {
    if (!(signal_.scale >= 1e-9 && signal_.scale <= 1e9)) {
      error("scale", "has the scale " + to_text(signal_.scale) + "; it must be positive, 0.000000001..1000000000");
      signal_.scale = 1.0;
    }
    signal_.decimals = decimals_of(signal_.scale);
    if (signal_.deadband < 0.0) {
      error("deadband", "has a negative deadband");
    }
  }

  /// A raw value as the device holds it.
  [[nodiscard]] bool fits(std::int64_t value) const {
    const auto raw = static_cast<canopen::Raw>(value);
    return canopen::normalise(signal_.type, raw) == raw && (canopen::is_signed(signal_.type) || value >= 0);
  }
  [[nodiscard]] std::string misfit() const {
    return ", which does not fit " + std::string(canopen::name_of(signal_.type));
  }

  void take_values() {
    const Node* const stated = said_.table->find("values");
    if (signal_.values.empty() || stated == nullptr) {
      return;
    }
    std::set<std::string> names;
    for (const auto& [number, entry] : read_numbered(*stated)) {
      const std::string label = "signal \"" + said_.name + "\" ";
      if (canopen::is_real(signal_.type)) {
        draft_.error(entry->key_place, label + "is a real number and takes no values");
      } else if (!fits(number)) {
        draft_.error(entry->key_place, label + "names " + entry->key + misfit());
      } else if (!names.insert(entry->value.text).second) {
        draft_.error(entry->value.place, label + "calls two values \"" + entry->value.text + "\"");
      }
    }
  }

  void take_momentary() {
    for (const std::int64_t value : keys_.momentary) {
      if (!fits(value)) {
        error("momentary", "has the momentary value " + std::to_string(value) + misfit());
      } else {
        signal_.momentary.push_back(static_cast<canopen::Raw>(value));
      }
    }
    if (!writable(signal_.access) && (!signal_.momentary.empty() || signal_.momentary_mask != 0)) {
      error(states("momentary") ? "momentary" : "momentary_mask", "cannot be written, so nothing of it is momentary");
    }
  }

  void take_edges() {
    for (const std::int64_t value : keys_.edge) {
      const auto raw = static_cast<canopen::Raw>(value);
      if (!fits(value)) {
        error("edge", "has the edge value " + std::to_string(value) + misfit());
      } else if (!is_momentary(signal_, raw)) {
        draft_.error(place_of(said_, "edge", {"momentary", "momentary_mask"}),
                     "signal \"" + said_.name + "\" has the edge value " + to_hex(raw) +
                         ", which is not momentary; an edge acts once, so name it in momentary, too");
      } else {
        signal_.edge.push_back(raw);
      }
    }
  }

  void take_stops() {
    if (signal_.name != "control_command") {
      refuse({"stop", "stop_masks", "edge"}, "is for control_command alone");
      return;
    }
    const canopen::Raw width = ~canopen::Raw{0} >> (64U - canopen::bit_length(signal_.type));
    for (const std::int64_t value : keys_.stop) {
      if (!fits(value)) {
        error("stop", "has the stop value " + std::to_string(value) + misfit());
      } else {
        add_stop("stop", {.mask = width, .equals = static_cast<canopen::Raw>(value) & width});
      }
    }
    for (const canopen::StopWord& word : keys_.stop_masks) {
      if ((word.mask & ~width) != 0) {
        error("stop_masks", "has the stop mask " + to_hex(word.mask) + misfit());
      } else if ((word.equals & ~word.mask) != 0) {
        error("stop_masks", "can never equal " + to_hex(word.equals) + " under its stop mask " + to_hex(word.mask));
      } else {
        add_stop("stop_masks", word);
      }
    }
    take_edges();
  }

  /// A fault reset or a jog is never a stop, whatever else is in the word.
  void add_stop(std::string_view key, const canopen::StopWord& stop) {
    const auto& momentary = signal_.momentary;
    const bool matched = std::any_of(momentary.begin(), momentary.end(),
                                     [&stop](canopen::Raw raw) { return (raw & stop.mask) == stop.equals; });
    // What the mask leaves open may have these bits, too.
    if (matched || (signal_.momentary_mask & (stop.equals | ~stop.mask)) != 0) {
      draft_.error(place_of(said_, key, {"momentary", "momentary_mask"}),
                   "signal \"" + said_.name + "\" has the stop " +
                       (key == "stop" ? "value " + to_hex(stop.equals) +
                                            ", which is momentary and so never a stop; leave one of them out"
                                      : "mask " + to_hex(stop.mask) + " with equals " + to_hex(stop.equals) +
                                            ", which lets in a momentary value; make the mask wider"));
    }
    draft_.drive.node.motor.stops.push_back(stop);
  }

  void take_limits() {
    const auto* const key = signal_.max.has_value() ? "max" : "min";
    if (!signal_.min.has_value() && !signal_.max.has_value()) {
      return;
    }
    if (!writable(signal_.access)) {
      error(key, "cannot be written; min and max are limits of what may be commanded");
    }
    if (signal_.min.has_value() && signal_.max.has_value() && *signal_.min > *signal_.max) {
      error("min", "has min " + to_text(*signal_.min) + " above max " + to_text(*signal_.max));
    }
    for (const auto* const limit : {"min", "max"}) {
      const auto& value = limit == std::string_view("min") ? signal_.min : signal_.max;
      if (value.has_value() && !canopen::from_number(signal_.type, *value / signal_.scale).has_value()) {
        error(limit, "has a limit of " + to_text(*value) + ", which " + std::string(canopen::name_of(signal_.type)) +
                         " with the scale " + to_text(signal_.scale) + " cannot hold");
      }
    }
  }

  DriveDraft& draft_;
  const Said<SignalKeys>& said_;
  const SignalKeys& keys_;
  Signal signal_;
};

/// In state messages the number of an enumerated signal stands beside it as NAME_code.
void check_code_names(const DriveDraft& draft) {
  for (const SignalDraft& enumerated : draft.signals) {
    if (enumerated.signal.values.empty() || !readable(enumerated.signal.access)) {
      continue;
    }
    const std::string code = enumerated.signal.name + "_code";
    for (const SignalDraft& other : draft.signals) {
      if (other.signal.name == code) {
        draft.error(other.said->place, "signal \"" + code + "\" cannot be called that: it is the number of the " +
                                           "enumerated \"" + enumerated.signal.name + "\"");
      }
    }
  }
}

}  // namespace

void take_signals(DriveDraft& draft) {
  for (const Said<SignalKeys>& said : draft.said.signals) {
    if (auto signal = SignalTaker(draft, said).take(); signal.has_value()) {
      draft.signals.push_back(*std::move(signal));
    }
  }
  check_code_names(draft);
}

}  // namespace config
