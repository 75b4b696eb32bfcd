#include "canopen/node/pdo.h"

#include <algorithm>
#include <stdexcept>

namespace canopen {
namespace {

constexpr unsigned kMaxPdoBits = 8 * kMaxPdoBytes;

constexpr Raw low_bits(unsigned count) noexcept {
  return count >= 64 ? ~Raw{0} : (Raw{1} << count) - 1;
}

}  // namespace

PdoPlan::PdoPlan(std::span<const MappedObject> mapping) {
  unsigned used = 0;
  for (const MappedObject& mapped : mapping) {
    if (mapped.bits == 0 || mapped.bits > kMaxPdoBits - used) {
      throw std::invalid_argument("PDO mapping: " + to_string(mapped.object) + " with " + std::to_string(mapped.bits) +
                                  " bits does not fit into 64 bits");
    }
    const unsigned of_value = std::min<unsigned>(mapped.bits, bit_length(mapped.type));
    Field field{};
    field.shift = static_cast<std::uint8_t>(used);
    field.dummy = is_dummy(mapped.object);
    field.mapped_bits = low_bits(mapped.bits);
    field.value_bits = low_bits(of_value);
    field.sign = is_signed(mapped.type) ? Raw{1} << (of_value - 1) : 0;
    fields_.push_back(field);
    used += mapped.bits;
  }
  byte_count_ = (used + 7) / 8;
}

// A PDO is never longer than 64 bits: as one number, every field is a shift and a mask, wherever it begins.
bool PdoPlan::decode(std::span<const std::uint8_t> bytes, std::span<Raw> values) const noexcept {
  if (bytes.size() < byte_count_ || values.size() < fields_.size()) {
    return false;
  }
  Raw all = 0;
  for (std::size_t i = 0; i < byte_count_; ++i) {
    all |= Raw{bytes[i]} << (8 * i);
  }
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const Field& field = fields_[i];
    const Raw value = (all >> field.shift) & field.value_bits;
    values[i] = field.dummy ? 0 : (value ^ field.sign) - field.sign;
  }
  return true;
}

std::array<std::uint8_t, kMaxPdoBytes> PdoPlan::encode(std::span<const Raw> values) const noexcept {
  Raw all = 0;
  for (std::size_t i = 0; i < fields_.size() && i < values.size(); ++i) {
    const Field& field = fields_[i];
    if (!field.dummy) {
      all |= (values[i] & field.mapped_bits) << field.shift;
    }
  }
  std::array<std::uint8_t, kMaxPdoBytes> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(all >> (8 * i));
  }
  return bytes;
}

}  // namespace canopen
