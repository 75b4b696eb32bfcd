#include <algorithm>
#include <tuple>

#include "config/drive_draft.h"
#include "config/nearest.h"
#include "config/reader.h"

namespace config {
namespace {

/// Words before booleans read out of them, then registers before bits, then by address.
auto rank_of(const SignalDraft& draft) {
  const ModbusPlace& place = draft.signal.modbus;
  return std::tuple(!draft.from.empty(), place.kind == ModbusKind::none, place.kind, place.address,
                    std::string_view(draft.signal.name));
}

void resolve(DriveDraft& draft, SignalDraft& derived) {
  const std::string label = "signal \"" + derived.signal.name + "\" ";
  const Place place = place_of(*derived.table, "from");
  const auto word = std::find_if(draft.signals.begin(), draft.signals.end(),
                                 [&derived](const SignalDraft& s) { return s.signal.name == derived.from; });
  if (word == draft.signals.end()) {
    std::vector<std::string_view> names;
    for (const SignalDraft& signal : draft.signals) {
      names.emplace_back(signal.signal.name);
    }
    draft.error(place, label + "reads \"" + derived.from + "\", which this drive does not have; nearest is \"" +
                           std::string(nearest(derived.from, names)) + "\"");
    return;
  }
  const canopen::DataType type = word->signal.type;
  const bool negative = derived.signal.derived->negative;
  if (!word->from.empty() || !readable(word->signal.access) || canopen::is_real(type) ||
      (negative && !canopen::is_signed(type))) {
    draft.error(place, label + "reads \"" + derived.from + "\", which must be a readable " +
                           (negative ? "signed integer" : "integer") + " with an object of its own");
    return;
  }
  const auto bits = canopen::bit_length(type);
  if (bits < 64 && (derived.signal.derived->mask >> bits) != 0) {
    draft.error(place_of(*derived.table, "mask"), label + "has a mask wider than \"" + derived.from + "\"");
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
    draft.error(draft.signals[*at].place, "signal \"" + signal.name + "\" must be a readable boolean");
    return std::nullopt;
  }
  return at;
}

}  // namespace

void finish_signals(DriveDraft& draft) {
  std::sort(draft.signals.begin(), draft.signals.end(),
            [](const SignalDraft& a, const SignalDraft& b) { return rank_of(a) < rank_of(b); });
  for (SignalDraft& signal : draft.signals) {
    if (!signal.from.empty()) {
      resolve(draft, signal);
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
}

}  // namespace config
