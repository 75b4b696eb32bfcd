#include "canopen/node/rpdo.h"

#include <algorithm>
#include <array>

namespace canopen {

Rpdo::Rpdo(const PdoSettings& settings) : number_(settings.number), cob_id_(settings.cob_id), plan_(settings.mapping) {
  for (const MappedObject& mapped : settings.mapping) {
    // A gap carries nothing, so nobody needs to command it.
    const FieldUse use = is_dummy(mapped.object) ? FieldUse::unused : mapped.use;
    fields_.push_back({mapped.object, use});
  }
}

bool Rpdo::maps(ObjectAddress object) const noexcept {
  return std::any_of(fields_.begin(), fields_.end(),
                     [&](const Field& field) { return field.use == FieldUse::commanded && field.object == object; });
}

bool Rpdo::complete(std::span<const ObjectValue> fields) const noexcept {
  const bool all_here =
      std::all_of(fields.begin(), fields.end(), [&](const auto& value) { return maps(value.object); });
  return all_here && !fields_.empty() && std::all_of(fields_.begin(), fields_.end(), [&](const Field& field) {
           return field.use == FieldUse::unused ||
                  (field.use == FieldUse::commanded && (field.known || given(field, fields) != nullptr));
         });
}

std::optional<Rpdo::Draft> Rpdo::build(std::span<const ObjectValue> fields) const noexcept {
  if (!complete(fields)) {
    return std::nullopt;
  }
  std::array<Raw, kMaxPdoFields> values{};
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const Field& field = fields_[i];
    const ObjectValue* value = given(field, fields);
    values[i] = field.use == FieldUse::unused ? 0 : (value != nullptr ? value->raw : field.value);
  }
  const auto bytes = plan_.encode(std::span(values).first(fields_.size()));
  return Draft{make_frame(cob_id_, std::span(bytes).first(plan_.byte_count())), command_epoch_, repeat_epoch_};
}

void Rpdo::confirm(const Draft& draft, std::span<const ObjectValue> fields) noexcept {
  last_confirmed_ = draft.repeat_epoch == repeat_epoch_ ? std::optional(draft.frame) : std::nullopt;
  for (const ObjectValue& value : fields) {
    set(value, draft.command_epoch == command_epoch_);
  }
}

void Rpdo::outcome_unknown(std::span<const ObjectValue> fields) noexcept {
  for (const ObjectValue& value : fields) {
    forget(value.object);
  }
}

void Rpdo::note(const ObjectValue& value) noexcept {
  if (!maps(value.object)) {
    return;
  }
  set(value, true);
  if (last_confirmed_) {
    replace_in_last_confirmed(value);
  }
  // A frame that is on its way just now may hold another value of this object; nobody can tell which came last.
  ++command_epoch_;
  ++repeat_epoch_;
}

void Rpdo::forget(ObjectAddress object) noexcept {
  if (!maps(object)) {
    return;
  }
  set({object}, false);
  last_confirmed_.reset();
  ++command_epoch_;
  ++repeat_epoch_;
}

void Rpdo::make_void() noexcept {
  make_void_but_repeat();
  last_confirmed_.reset();
  ++repeat_epoch_;
}

void Rpdo::make_void_but_repeat() noexcept {
  for (Field& field : fields_) {
    field.known = false;
  }
  ++command_epoch_;
}

const ObjectValue* Rpdo::given(const Field& field, std::span<const ObjectValue> fields) noexcept {
  // The last one counts: fields are applied in the order in which they were given.
  const auto found = std::find_if(fields.rbegin(), fields.rend(),
                                  [&](const ObjectValue& value) { return value.object == field.object; });
  return found == fields.rend() ? nullptr : &*found;
}

void Rpdo::set(const ObjectValue& value, bool known) noexcept {
  for (Field& field : fields_) {
    if (field.use == FieldUse::commanded && field.object == value.object) {
      field.known = known;
      field.value = value.raw;
    }
  }
}

void Rpdo::replace_in_last_confirmed(const ObjectValue& value) noexcept {
  std::array<Raw, kMaxPdoFields> values{};
  if (!plan_.decode(last_confirmed_->bytes(), values)) {
    return;
  }
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    if (fields_[i].use == FieldUse::commanded && fields_[i].object == value.object) {
      values[i] = value.raw;
    }
  }
  const auto bytes = plan_.encode(std::span(values).first(fields_.size()));
  last_confirmed_ = make_frame(cob_id_, std::span(bytes).first(plan_.byte_count()));
}

}  // namespace canopen
