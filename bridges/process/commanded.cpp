#include "bridges/process/commanded.h"

#include <algorithm>

#include "bridges/process/command_checks.h"
#include "bridges/process/stop_check.h"

namespace process {
namespace {

const Field* find_given(std::span<const Field> given, SignalId signal) noexcept {
  const auto found =
      std::find_if(given.begin(), given.end(), [=](const Field& field) { return field.signal == signal; });
  return found == given.end() ? nullptr : &*found;
}

bool is_edge(const config::Signal& signal, canopen::Raw raw) noexcept {
  return std::find(signal.edge.begin(), signal.edge.end(), raw) != signal.edge.end();
}

}  // namespace

Commanded::Commanded(const config::Drive& model) : model_(model), values_(model.signals.size()) {
  if (const auto control = model.find("control_command")) {
    control_ = static_cast<SignalId>(*control);
  }
  for (const canopen::PdoSettings& settings : model.node.rpdos) {
    Rpdo rpdo{.number = settings.number,
              .supervised = canopen::repeat_time(settings) > canopen::Duration::zero(),
              .fields = {}};
    for (const canopen::MappedObject& mapped : settings.mapping) {
      const auto signal = writable_signal(model, mapped.object);
      if (canopen::is_commanded(mapped) && signal) {
        rpdo.fields.push_back({*signal, mapped.object, model.signals[*signal].type});
      } else if (canopen::is_commanded(mapped) || canopen::is_unnamed(mapped)) {
        rpdo.can_be_complete = false;
      }
    }
    rpdo.can_be_complete = rpdo.can_be_complete && !settings.mapping.empty();
    rpdos_.push_back(std::move(rpdo));
  }
}

canopen::Raw Commanded::shown(SignalId signal) const noexcept {
  return values_[signal].shown;
}

bool Commanded::counts(SignalId signal) const noexcept {
  return values_[signal].counts;
}

std::optional<canopen::Raw> Commanded::known(SignalId signal) const noexcept {
  return values_[signal].counts ? values_[signal].held : std::nullopt;
}

std::optional<canopen::Raw> Commanded::held(SignalId signal) const noexcept {
  return is_control(signal) ? control_held() : values_[signal].held;
}

std::optional<canopen::TimePoint> Commanded::confirmed_at(SignalId signal) const noexcept {
  return values_[signal].counts ? std::optional(values_[signal].confirmed) : std::nullopt;
}

std::optional<canopen::TimePoint> Commanded::last_confirmed_at(SignalId signal) const noexcept {
  const canopen::TimePoint at = values_[signal].confirmed;
  return at == canopen::TimePoint{} ? std::nullopt : std::optional(at);
}

std::optional<canopen::TimePoint> Commanded::doubtful_at(SignalId signal) const noexcept {
  return values_[signal].doubtful;
}

std::string_view Commanded::control_void_since(Epoch epoch) const noexcept {
  return control_void_.epoch > epoch ? std::string_view(control_void_.what) : std::string_view();
}

std::string_view Commanded::all_void_since(Epoch epoch) const noexcept {
  return all_void_.epoch > epoch ? std::string_view(all_void_.what) : std::string_view();
}

void Commanded::confirm(std::span<const Field> fields, std::uint16_t rpdo, Epoch since, bool control_counts,
                        canopen::TimePoint now) {
  const Field* given = control_ ? find_given(fields, *control_) : nullptr;
  const auto word = given != nullptr && stopped_ <= since ? std::optional(given->raw) : repeated_control();
  for (const Field& field : fields) {
    Value& value = values_[field.signal];
    const bool control = is_control(field.signal);
    const bool outlived = control ? control_void_.epoch > since : all_void_.epoch > since;
    value.shown = field.raw;
    value.held = all_void_.epoch > since ? std::nullopt : std::optional(field.raw);
    value.counts =
        !outlived && (control_counts || !control) && !config::is_momentary(model_.signals[field.signal], field.raw);
    value.confirmed = now;
    if (control) {
      note_confirmed_control(field.raw, stopped_ > since, outlived);
    }
  }
  for (Rpdo& each : rpdos_) {
    const bool mine = each.number == rpdo;
    if (mine) {
      each.repeats = silenced_ <= since && (fault_end_ <= since || outlasts_fault(each, word));
    }
    for (const Field& field : fields) {
      note_repetition(field, each, mine);
    }
  }
}

void Commanded::note_confirmed_control(canopen::Raw raw, bool before_stop, bool outlived) {
  if (before_stop) {
    // The answer to an older command: the stop that came meanwhile may be confirmed already, by RPDO.
    replace_repeated_control(stop_);
  } else if (outlived && !may_go_on(raw)) {
    replace_repeated_control(canopen::first_stop(model_.node.motor));
  } else {
    repeated_instead_.reset();
  }
}

/// A momentary value is repeated only where its RPDO carried it and the drive acts on its edge: one that acts on the
/// level would reset the next fault, too.
void Commanded::note_repetition(const Field& field, Rpdo& rpdo, bool by_this_rpdo) {
  const config::Signal& signal = model_.signals[field.signal];
  if (!maps(rpdo, field.signal) || !config::is_momentary(signal, field.raw)) {
    return;
  }
  if (!by_this_rpdo || !is_edge(signal, field.raw)) {
    rpdo.repeats = false;
  }
}

void Commanded::doubt(std::span<const Field> fields, Epoch since, canopen::TimePoint now) {
  for (const Field& field : fields) {
    Value& value = values_[field.signal];
    value.held.reset();
    value.counts = false;
    value.doubtful = now;
    if (is_control(field.signal) && stopped_ > since) {
      replace_repeated_control(stop_);
    }
  }
  for (Rpdo& rpdo : rpdos_) {
    const bool carries = std::any_of(fields.begin(), fields.end(), [&](const Field& field) {
      return maps(rpdo, field.signal) && !(is_control(field.signal) && stopped_ > since);
    });
    rpdo.repeats = rpdo.repeats && !carries;
  }
}

void Commanded::void_control(std::string_view what) {
  ++epoch_;
  control_void_ = {epoch_, std::string(what)};
  if (control_) {
    values_[*control_].counts = false;
  }
}

void Commanded::end_repetition() {
  silenced_ = epoch_;
  for (Rpdo& rpdo : rpdos_) {
    rpdo.repeats = false;
  }
}

void Commanded::on_fault_begin(std::string_view what) {
  void_control(what);
  end_repetition();
}

void Commanded::on_fault_end() {
  void_control("a fault ended");
  fault_end_ = epoch_;
  for (Rpdo& rpdo : rpdos_) {
    rpdo.repeats = rpdo.repeats && outlasts_fault(rpdo, repeated_control());
  }
}

void Commanded::on_standstill(std::string_view what) {
  void_control(what);
  const std::optional<canopen::Raw> repeated = repeated_control();
  if (repeated && !may_go_on(*repeated)) {
    replace_repeated_control(canopen::first_stop(model_.node.motor));
  }
}

void Commanded::on_stop(canopen::Raw control) {
  void_control("a stop came");
  stopped_ = epoch_;
  stop_ = control;
  replace_repeated_control(control);
}

void Commanded::replace_repeated_control(std::optional<canopen::Raw> stop) {
  if (!stop) {
    end_repetition();
  } else if (std::any_of(rpdos_.begin(), rpdos_.end(), [](const Rpdo& rpdo) { return rpdo.supervised; })) {
    repeated_instead_ = stop;
  }
}

void Commanded::on_session_end(std::string_view what) {
  void_control(what);
  all_void_ = control_void_;
  for (Value& value : values_) {
    value.held.reset();
    value.counts = false;
  }
  repeated_instead_.reset();
  end_repetition();
}

std::uint16_t Commanded::rpdo_of(SignalId signal) const noexcept {
  const auto found = std::find_if(rpdos_.begin(), rpdos_.end(), [=](const Rpdo& rpdo) { return maps(rpdo, signal); });
  return found == rpdos_.end() ? std::uint16_t{0} : found->number;
}

bool Commanded::is_supervised(SignalId signal) const noexcept {
  const Rpdo* rpdo = find(rpdo_of(signal));
  return rpdo != nullptr && rpdo->supervised;
}

std::optional<std::vector<SignalId>> Commanded::missing(std::uint16_t rpdo, std::span<const Field> given) const {
  const Rpdo* found = find(rpdo);
  if (found == nullptr || !found->can_be_complete) {
    return std::nullopt;
  }
  std::vector<SignalId> missing;
  for (const MappedSignal& mapped : found->fields) {
    if (find_given(given, mapped.signal) == nullptr && !known(mapped.signal)) {
      missing.push_back(mapped.signal);
    }
  }
  return missing;
}

std::optional<std::vector<canopen::ObjectValue>> Commanded::values(std::uint16_t rpdo,
                                                                   std::span<const Field> given) const {
  const auto lacking = missing(rpdo, given);
  if (!lacking || !lacking->empty()) {
    return std::nullopt;
  }
  const Rpdo& found = *find(rpdo);
  std::vector<canopen::ObjectValue> values;
  std::size_t used = 0;
  for (const MappedSignal& mapped : found.fields) {
    const Field* field = find_given(given, mapped.signal);
    used += field != nullptr ? 1U : 0U;
    values.push_back({mapped.object, mapped.type, field != nullptr ? field->raw : known(mapped.signal).value_or(0)});
  }
  return used == given.size() ? std::optional(std::move(values)) : std::nullopt;
}

std::optional<std::vector<canopen::ObjectValue>> Commanded::repetition(std::uint16_t rpdo) const {
  const Rpdo* found = find(rpdo);
  if (found == nullptr || !found->repeats) {
    return std::nullopt;
  }
  std::vector<canopen::ObjectValue> values;
  for (const MappedSignal& mapped : found->fields) {
    const auto raw = is_control(mapped.signal) ? repeated_control() : values_[mapped.signal].held;
    if (!raw) {
      return std::nullopt;
    }
    values.push_back({mapped.object, mapped.type, *raw});
  }
  return values;
}

bool Commanded::is_stop(canopen::Raw control) const noexcept {
  return control_ && process::is_stop(model_, model_.signals[*control_], control);
}

bool Commanded::maps(const Rpdo& rpdo, SignalId signal) noexcept {
  return std::any_of(rpdo.fields.begin(), rpdo.fields.end(),
                     [=](const MappedSignal& mapped) { return mapped.signal == signal; });
}

const Commanded::Rpdo* Commanded::find(std::uint16_t number) const noexcept {
  const auto found =
      std::find_if(rpdos_.begin(), rpdos_.end(), [=](const Rpdo& rpdo) { return rpdo.number == number; });
  return found == rpdos_.end() ? nullptr : &*found;
}

std::optional<canopen::Raw> Commanded::control_held() const noexcept {
  // Once a stop is repeated in its place, nobody knows which of the two the drive holds.
  return repeated_instead_ ? std::nullopt : repeated_control();
}

std::optional<canopen::Raw> Commanded::repeated_control() const noexcept {
  return control_ && !repeated_instead_ ? values_[*control_].held : repeated_instead_;
}

bool Commanded::may_go_on(canopen::Raw control) const noexcept {
  return is_stop(control) || (control_ && is_edge(model_.signals[*control_], control));
}

/// What was commanded while the drive could not run must not start it; a stop may go on, and so does the reset itself
/// where only its edge counts.
bool Commanded::outlasts_fault(const Rpdo& rpdo, std::optional<canopen::Raw> control) const noexcept {
  return !control_ || !maps(rpdo, *control_) || (control && may_go_on(*control));
}

}  // namespace process
