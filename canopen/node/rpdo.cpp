#include "canopen/node/rpdo.h"

#include <algorithm>
#include <array>

namespace canopen {

Rpdo::Rpdo(const PdoSettings& settings) : number_(settings.number), cob_id_(settings.cob_id), plan_(settings.mapping) {
  for (const MappedObject& mapped : settings.mapping) {
    // A gap carries nothing, so nobody needs to command it.
    fields_.push_back({mapped.object, is_dummy(mapped.object) ? FieldUse::unused : mapped.use});
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
                  (field.use == FieldUse::commanded && (field.known || find(field, fields) != nullptr));
         });
}

std::optional<Frame> Rpdo::begin(std::span<const ObjectValue> fields) noexcept {
  if (!complete(fields)) {
    return std::nullopt;
  }
  for (Field& field : fields_) {
    const ObjectValue* value = find(field, fields);
    field.given = value != nullptr;
    field.on_its_way = value != nullptr ? value->raw : field.known.value_or(0);
  }
  will_count_ = true;
  will_repeat_ = true;
  return frame_of(&Field::on_its_way);
}

bool Rpdo::relies_on_known() const noexcept {
  return std::any_of(fields_.begin(), fields_.end(),
                     [](const Field& field) { return field.use == FieldUse::commanded && !field.given; });
}

void Rpdo::left() noexcept {
  for (Field& field : fields_) {
    field.repeated = field.on_its_way;
    if (field.given) {
      field.known = will_count_ ? std::optional(field.on_its_way) : std::nullopt;
    }
  }
  repeats_ = will_repeat_;
}

void Rpdo::outcome_unknown() noexcept {
  for (Field& field : fields_) {
    if (field.given) {
      field.known.reset();
      repeats_ = false;
    }
  }
}

void Rpdo::note(const ObjectValue& value) noexcept {
  for (Field& field : fields_) {
    if (field.use == FieldUse::commanded && field.object == value.object) {
      field.known = value.raw;
      field.repeated = value.raw;
      // A frame on its way may hold another value of this object; nobody can tell which came last.
      will_count_ = false;
      will_repeat_ = false;
    }
  }
}

void Rpdo::forget(ObjectAddress object) noexcept {
  for (Field& field : fields_) {
    if (field.use == FieldUse::commanded && field.object == object) {
      field.known.reset();
      repeats_ = false;
      will_count_ = false;
      will_repeat_ = false;
    }
  }
}

void Rpdo::make_void(bool keep_repeating) noexcept {
  for (Field& field : fields_) {
    field.known.reset();
  }
  will_count_ = false;
  repeats_ = repeats_ && keep_repeating;
  will_repeat_ = will_repeat_ && keep_repeating;
}

std::optional<Frame> Rpdo::repeated() const noexcept {
  return repeats_ ? std::optional(frame_of(&Field::repeated)) : std::nullopt;
}

const ObjectValue* Rpdo::find(const Field& field, std::span<const ObjectValue> fields) noexcept {
  // The last one counts: fields are applied in the order in which they were given.
  const auto found = std::find_if(fields.rbegin(), fields.rend(), [&](const ObjectValue& value) {
    return field.use == FieldUse::commanded && value.object == field.object;
  });
  return found == fields.rend() ? nullptr : &*found;
}

Frame Rpdo::frame_of(Raw Field::* value) const noexcept {
  std::array<Raw, kMaxPdoFields> values{};
  std::transform(fields_.begin(), fields_.end(), values.begin(), [&](const Field& field) { return field.*value; });
  const auto bytes = plan_.encode(std::span(values).first(fields_.size()));
  return make_frame(cob_id_, std::span(bytes).first(plan_.byte_count()));
}

}  // namespace canopen
