#include <algorithm>
#include <set>
#include <tuple>

#include "config/drive/builder.h"
#include "config/schema/complaint.h"
#include "config/schema/nearest.h"
#include "config/toml/document.h"

namespace config {
namespace {

/// Words before booleans read out of them, then registers before bits, then by address.
auto rank_of(const SignalDraft& draft) {
  const ModbusPlace& place = draft.signal.modbus;
  return std::tuple(draft.derived(), place.kind == ModbusKind::none, place.kind, place.address,
                    std::string_view(draft.signal.name));
}

/// Where a signal that has an object was switched off; nothing for one that never was.
std::optional<Place> switched_off(const DriveDraft& draft, std::string_view name) {
  for (const Said<SignalKeys>& said : draft.said.signals) {
    if (said.name == name && !said.keys.enabled && said.keys.object.has_value()) {
      return place_of(said, "enabled");
    }
  }
  return std::nullopt;
}

/// One finding for all that is read out of a word that is not there.
void explain_missing(const DriveDraft& draft, const std::string& word) {
  std::string readers;
  Place place;
  for (const SignalDraft& signal : draft.signals) {
    if (signal.derived() && *signal.said->keys.from == word) {
      place = readers.empty() ? place_of(*signal.said, "from") : place;
      readers += (readers.empty() ? "" : ", ") + in_quotes(signal.signal.name);
    }
  }
  if (const auto off = switched_off(draft, word); off.has_value()) {
    draft.error(*off, "signal " + in_quotes(word) + " is switched off, but " + readers +
                          " are read out of it; switch them off, too, or leave it");
    return;
  }
  std::vector<std::string_view> names;
  for (const SignalDraft& signal : draft.signals) {
    names.emplace_back(signal.signal.name);
  }
  const auto near = nearest(word, names);
  draft.error(place, "signal " + readers + " reads " + in_quotes(word) + ", which this drive does not have" +
                         (near.empty() ? "" : "; nearest is " + in_quotes(near)));
}

void resolve(const DriveDraft& draft, SignalDraft& derived, std::set<std::string>& missing) {
  const std::string& from = *derived.said->keys.from;
  const std::string label = "signal \"" + derived.signal.name + "\" ";
  const auto word = std::find_if(draft.signals.begin(), draft.signals.end(),
                                 [&from](const SignalDraft& s) { return s.signal.name == from; });
  if (word == draft.signals.end()) {
    if (missing.insert(from).second) {
      explain_missing(draft, from);
    }
    return;
  }
  const canopen::DataType type = word->signal.type;
  const bool negative = derived.signal.derived->negative;
  if (word->derived() || !readable(word->signal.access) || canopen::is_real(type) ||
      (negative && !canopen::is_signed(type))) {
    const auto* const cause = readable(word->signal.access) ? "type" : "access";
    draft.error(in_the_site(place_of(*derived.said, "from"), place_of(*word->said, cause)),
                label + "reads \"" + from + "\", which must be a readable " +
                    (negative ? "signed integer" : "integer") + " with an object of its own");
    return;
  }
  const auto bits = canopen::bit_length(type);
  if (bits < 64 && (derived.signal.derived->mask >> bits) != 0) {
    draft.error(in_the_site(place_of(*derived.said, "mask"), place_of(*word->said, "type")),
                label + "has a mask wider than \"" + from + "\"");
  }
  derived.signal.derived->from = static_cast<std::size_t>(word - draft.signals.begin());
  derived.signal.object = word->signal.object;
  derived.signal.source = word->signal.source;
  derived.signal.poll = word->signal.poll;
  derived.signal.unconfirmed |= word->signal.unconfirmed;
}

std::optional<std::size_t> boolean_of(DriveDraft& draft, std::string_view name) {
  const auto at = draft.drive.find(name);
  if (!at.has_value()) {
    return std::nullopt;
  }
  const Signal& signal = draft.drive.signals[*at];
  if (signal.type != canopen::DataType::boolean || !readable(signal.access)) {
    draft.error(draft.signals[*at].said->place, "signal \"" + signal.name + "\" must be a readable boolean");
    return std::nullopt;
  }
  return at;
}

/// The same boolean as the master reads it by SDO.
std::optional<canopen::MotorSign> sign_of(const Drive& drive, std::optional<std::size_t> boolean) {
  if (!boolean.has_value()) {
    return std::nullopt;
  }
  const Signal& signal = drive.signals[*boolean];
  if (!signal.derived.has_value()) {
    return canopen::MotorSign{.object = signal.object, .type = signal.type, .values = {1}};
  }
  const auto& [from, mask, values, negative] = *signal.derived;
  const Signal& word = drive.signals[from];
  return canopen::MotorSign{
      .object = word.object, .type = word.type, .mask = mask, .values = values, .negative = negative};
}

void find_motor(Drive& drive) {
  canopen::MotorSigns& motor = drive.node.motor;
  motor.running = sign_of(drive, drive.faults.running);
  motor.fault = sign_of(drive, drive.faults.fault);
  if (const auto control = drive.find("control_command"); control.has_value()) {
    motor.control = drive.signals[*control].object;
    motor.control_type = drive.signals[*control].type;
  }
}

}  // namespace

void order_signals(DriveDraft& draft) {
  std::sort(draft.signals.begin(), draft.signals.end(),
            [](const SignalDraft& a, const SignalDraft& b) { return rank_of(a) < rank_of(b); });
  std::set<std::string> missing;
  for (SignalDraft& signal : draft.signals) {
    if (signal.derived()) {
      resolve(draft, signal, missing);
    }
  }
  for (const SignalDraft& signal : draft.signals) {
    draft.drive.signals.push_back(signal.signal);
  }
  FaultRules& faults = draft.drive.faults;
  faults.running = boolean_of(draft, "running");
  faults.quick_stop = boolean_of(draft, "quick_stop_active");
  faults.fault = boolean_of(draft, "fault");
  faults.warning = boolean_of(draft, "warning");
  const auto code = draft.drive.find("fault_code");
  if (code.has_value() && readable(draft.drive.signals[*code].access)) {
    faults.fault_code = code;
  }
  find_motor(draft.drive);
}

}  // namespace config
