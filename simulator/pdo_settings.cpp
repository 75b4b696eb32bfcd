#include "simulator/pdo_settings.h"

namespace simulator {

std::optional<Triggers> standard_triggers(std::uint8_t /*number*/, std::uint8_t type, std::uint16_t event) {
  Triggers triggers;
  if (type == 0) {
    triggers.changed_at_sync = true;
  } else if (type <= 240) {
    triggers.every_sync = type;
  } else if (type == 252 || type == 253) {
    triggers.remote = true;
  } else if (type >= 254) {
    triggers.change = true;
    triggers.timer = event != 0;
  } else {
    return std::nullopt;
  }
  return triggers;
}

Abort check_entry(ObjectDictionary& dictionary, std::uint32_t value, bool transmit) {
  const MapEntry entry = map_entry(value);
  const Object* object = dictionary.find(entry.address);
  if (object == nullptr) {
    return dictionary.absence(entry.address);
  }
  const Mappable wanted = transmit ? Mappable::transmit : Mappable::receive;
  if (object->mappable != Mappable::both && object->mappable != wanted) {
    return Abort::not_mappable;
  }
  return entry.bits == 8 * object->size ? Abort::none : Abort::not_mappable;
}

Abort check_map(ObjectDictionary& dictionary, const PdoSettings& settings, std::uint8_t count, bool transmit) {
  if (count > kMapEntries) {
    return Abort::mapping_too_long;
  }
  unsigned bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Abort abort = check_entry(dictionary, settings.map[i], transmit);
    if (abort != Abort::none) {
      return abort;
    }
    bits += map_entry(settings.map[i]).bits;
  }
  return bits <= 64 ? Abort::none : Abort::mapping_too_long;
}

std::uint8_t mapped_bytes(const PdoSettings& settings) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < settings.count; ++i) {
    bits += map_entry(settings.map[i]).bits;
  }
  return static_cast<std::uint8_t>(bits / 8);
}

std::optional<canopen::Frame> pack(ObjectDictionary& dictionary, const PdoSettings& settings) {
  if (settings.count == 0) {
    return std::nullopt;
  }
  canopen::Frame frame;
  frame.id = settings.id();
  for (std::size_t i = 0; i < settings.count; ++i) {
    const MapEntry entry = map_entry(settings.map[i]);
    const Object* object = dictionary.find(entry.address);
    const std::uint32_t value = object != nullptr ? ObjectDictionary::read(*object) : 0;
    for (unsigned shift = 0; shift < entry.bits && frame.size < 8; shift += 8) {
      frame.data[frame.size++] = static_cast<std::uint8_t>(value >> shift);
    }
  }
  return frame;
}

void unpack(ObjectDictionary& dictionary, const PdoSettings& settings, const canopen::Frame& frame) {
  std::size_t position = 0;
  for (std::size_t i = 0; i < settings.count; ++i) {
    const MapEntry entry = map_entry(settings.map[i]);
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < entry.bits && position < frame.size; shift += 8) {
      value |= static_cast<std::uint32_t>(frame.data[position++]) << shift;
    }
    if (Object* object = dictionary.find(entry.address)) {
      // A PDO has no answer: a refused value is lost, as on the real drive.
      static_cast<void>(ObjectDictionary::write(*object, value));
    }
  }
}

}  // namespace simulator
