#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "config/drive_draft.h"
#include "config/nearest.h"
#include "config/reader.h"
#include "config/text.h"

namespace config {
namespace {

// Fixed topics beside the signals of a drive, and the key of a command's identifier.
constexpr std::array<std::string_view, 9> kReserved{"state", "status",  "alarm",   "nmt", "sdo",
                                                    "set",   "control", "history", "id"};

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

class SignalReader {
 public:
  SignalReader(DriveDraft& draft, const Entry& entry) : draft_(draft), table_(entry.value) {
    result_.table = &entry.value;
    result_.place = entry.key_place;
    signal_.name = entry.key;
    label_ = "signal \"" + entry.key + "\" ";
  }

  /// Nothing where the signal is not enabled, or cannot be understood.
  std::optional<SignalDraft> read() {
    if (!read_boolean(table_, "enabled").value_or(true)) {
      return std::nullopt;
    }
    if (std::find(kReserved.begin(), kReserved.end(), signal_.name) != kReserved.end()) {
      draft_.error(result_.place, label_ + "cannot be called that: the name is that of a fixed topic");
    }
    const bool good = table_.find("from") != nullptr ? read_derived() : read_object_keys();
    if (!good) {
      return std::nullopt;
    }
    take(signal_.unconfirmed, read_boolean(table_, "unconfirmed"));
    result_.signal = std::move(signal_);
    return std::move(result_);
  }

 private:
  void error(std::string_view key, const std::string& text) {
    draft_.error(table_.find(key) == nullptr ? result_.place : place_of(table_, key), label_ + text);
  }

  bool read_derived() {
    constexpr std::array kWithout{"object", "type",      "scale",          "source", "min", "max",
                                  "values", "momentary", "momentary_mask", "as",     "poll"};
    for (const auto* const key : kWithout) {
      if (table_.find(key) != nullptr) {
        error(key, std::string(key) + " has no meaning beside from");
      }
    }
    if (read_text(table_, "access").value_or("read") != "read") {
      error("access", "is read out of another one and cannot be written");
    }
    result_.from = read_text(table_, "from").value_or("");
    Derived derived;
    derived.mask = static_cast<std::uint64_t>(read_integer(table_, "mask").value_or(0));
    derived.negative = read_boolean(table_, "negative").value_or(false);
    for (const std::int64_t value : read_integers(table_, "equals")) {
      derived.values.push_back(static_cast<std::uint64_t>(value));
      if ((derived.values.back() & ~derived.mask) != 0) {
        error("equals", "can never equal " + to_hex(derived.values.back()) + " under its mask");
      }
    }
    if (derived.values.empty() && !derived.negative) {
      derived.values.push_back(derived.mask);
    }
    if (derived.negative == (table_.find("mask") != nullptr)) {
      error("from", "needs either mask or negative = true");
      return false;
    }
    signal_.type = canopen::DataType::boolean;
    signal_.derived = std::move(derived);
    return true;
  }

  bool read_object_keys() {
    const auto object = read_object(table_, "object");
    const auto type = read_type(table_, "type");
    if (!object.has_value() || !type.has_value()) {
      if (table_.find("object") == nullptr || table_.find("type") == nullptr) {
        explain_unknown();
      }
      return false;
    }
    signal_.object = *object;
    signal_.type = *type;
    signal_.unit = read_text(table_, "unit").value_or("");
    take(signal_.poll, read_duration(table_, "poll"));
    take(signal_.publish_mask, read_as<std::uint64_t>(table_, "publish_mask"));
    read_access();
    read_scale();
    read_values();
    read_momentary();
    read_limits();
    return true;
  }

  /// A name that profile and presets do not have is mostly a typing mistake.
  void explain_unknown() {
    std::vector<std::string_view> names;
    for (const Entry& other : read_table(draft_.merged, "signals")->entries) {
      if (other.value.find("object") != nullptr || other.value.find("from") != nullptr) {
        names.emplace_back(other.key);
      }
    }
    const auto near = nearest(signal_.name, names);
    draft_.error(result_.place, label_ + "is not in profile \"" + draft_.drive.profile + "\"" +
                                    (near.empty() ? "" : ", where \"" + std::string(near) + "\" is nearest") +
                                    "; a signal of your own needs object and type");
  }

  void read_access() {
    const auto access = read_text(table_, "access");
    if (access == "write") {
      signal_.access = Access::write;
    } else if (access == "read-write") {
      signal_.access = Access::read_write;
    }
  }

  void read_scale() {
    take(signal_.scale, read_number(table_, "scale"));
    if (!(signal_.scale >= 1e-9 && signal_.scale <= 1e9)) {
      error("scale", "has the scale " + to_text(signal_.scale) + "; it must be positive, 0.000000001..1000000000");
      signal_.scale = 1.0;
    }
    signal_.decimals = decimals_of(signal_.scale);
    take(signal_.deadband, read_number(table_, "deadband"));
    if (signal_.deadband < 0.0) {
      error("deadband", "has a negative deadband");
    }
  }

  /// A raw value as the device holds it.
  [[nodiscard]] bool fits(std::int64_t value) const {
    const auto raw = static_cast<canopen::Raw>(value);
    return canopen::normalise(signal_.type, raw) == raw && (canopen::is_signed(signal_.type) || value >= 0);
  }

  void read_values() {
    std::set<std::string> names;
    for (const auto& [number, entry] : read_numbered(table_, "values")) {
      const std::string& name = entry->value.text;
      if (canopen::is_real(signal_.type)) {
        draft_.error(entry->key_place, label_ + "is a real number and takes no values");
      } else if (!fits(number)) {
        draft_.error(entry->key_place, label_ + "names " + entry->key + ", which does not fit " +
                                           std::string(canopen::name_of(signal_.type)));
      } else if (!names.insert(name).second) {
        draft_.error(entry->value.place, label_ + "calls two values \"" + name + "\"");
      }
      signal_.values.insert_or_assign(number, name);
    }
  }

  void read_momentary() {
    for (const std::int64_t value : read_integers(table_, "momentary")) {
      if (!fits(value)) {
        error("momentary", "has the momentary value " + std::to_string(value) + ", which does not fit " +
                               std::string(canopen::name_of(signal_.type)));
      }
      signal_.momentary.push_back(static_cast<canopen::Raw>(value));
    }
    take(signal_.momentary_mask, read_as<std::uint64_t>(table_, "momentary_mask"));
    if (!writable(signal_.access) && (!signal_.momentary.empty() || signal_.momentary_mask != 0)) {
      error("momentary", "cannot be written, so nothing of it is momentary");
    }
  }

  void read_limits() {
    signal_.min = read_number(table_, "min");
    signal_.max = read_number(table_, "max");
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
    for (const auto& limit : {signal_.min, signal_.max}) {
      if (limit.has_value() && !canopen::from_number(signal_.type, *limit / signal_.scale).has_value()) {
        error(key, "has a limit of " + to_text(*limit) + ", which " + std::string(canopen::name_of(signal_.type)) +
                       " with the scale " + to_text(signal_.scale) + " cannot hold");
      }
    }
  }

  DriveDraft& draft_;
  const Node& table_;
  Signal signal_;
  SignalDraft result_;
  std::string label_;
};

/// In state messages the number of an enumerated signal stands beside it as NAME_code.
void check_code_names(DriveDraft& draft) {
  for (const SignalDraft& enumerated : draft.signals) {
    if (enumerated.signal.values.empty() || !readable(enumerated.signal.access)) {
      continue;
    }
    const std::string code = enumerated.signal.name + "_code";
    for (const SignalDraft& other : draft.signals) {
      if (other.signal.name == code) {
        draft.error(other.place, "signal \"" + code +
                                     "\" cannot be called that: it is the number of the enumerated \"" +
                                     enumerated.signal.name + "\"");
      }
    }
  }
}

}  // namespace

void read_signals(DriveDraft& draft) {
  const Node* const signals = read_table(draft.merged, "signals");
  if (signals == nullptr) {
    return;
  }
  for (const Entry& entry : signals->entries) {
    if (entry.value.kind != NodeKind::table || !is_signal_name(entry.key)) {
      continue;
    }
    if (auto signal = SignalReader(draft, entry).read(); signal.has_value()) {
      draft.signals.push_back(*std::move(signal));
    }
  }
  check_code_names(draft);
}

}  // namespace config
