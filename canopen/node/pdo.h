#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "canopen/node/node_settings.h"
#include "canopen/object.h"

namespace canopen {

inline constexpr std::size_t kMaxPdoBytes = 8;
inline constexpr std::size_t kMaxPdoFields = 64;  ///< 64 objects of one bit (CiA 301 §7.5.2.36).

/// Where the values of one PDO lie, worked out once from its mapping. Fields may start at any bit and be 1 to 64 bits
/// wide; bit 0 of the PDO is bit 0 of byte 0 (CiA 301 §7.3.5.1). Neither decode() nor encode() allocates.
class PdoPlan {
 public:
  /// Throws std::invalid_argument for more than 64 bits, or a field of 0 or more than 64 bits.
  explicit PdoPlan(std::span<const MappedObject> mapping);

  /// Bytes of the PDO; a last byte may be partly used.
  [[nodiscard]] std::size_t byte_count() const noexcept { return byte_count_; }
  [[nodiscard]] std::size_t field_count() const noexcept { return fields_.size(); }

  /// Fills the first field_count() of `values` in mapping order, dummies as 0. Bytes beyond byte_count() are ignored
  /// (CiA 301 §7.2.2.5). False, and nothing written, where there are fewer or `values` is too small. Integers that
  /// are mapped with fewer bits than their type are extended by their sign.
  [[nodiscard]] bool decode(std::span<const std::uint8_t> bytes, std::span<Raw> values) const noexcept;

  /// The PDO's bytes; dummies and unused bits are 0. `values` holds field_count() values in mapping order; bits beyond
  /// the mapped ones are cut.
  [[nodiscard]] std::array<std::uint8_t, kMaxPdoBytes> encode(std::span<const Raw> values) const noexcept;

 private:
  struct Field {
    std::uint8_t shift;  ///< First bit in the PDO.
    bool dummy;
    Raw mapped_bits;  ///< A mask as wide as mapped.
    Raw value_bits;   ///< A mask as wide as the type, where that is narrower.
    Raw sign;         ///< The sign's bit, 0: not signed.
  };

  std::vector<Field> fields_;
  std::size_t byte_count_ = 0;
};

}  // namespace canopen
