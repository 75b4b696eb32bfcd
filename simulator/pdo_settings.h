#pragma once

#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <functional>
#include <optional>

#include "canopen/frame.h"
#include "simulator/nmt_state.h"
#include "simulator/object_dictionary.h"
#include "simulator/pdo_rules.h"
#include "simulator/record.h"

namespace simulator {

inline constexpr std::uint32_t kPdoDisabled = 0x80000000U;  ///< bit 31 of sub-index 1
inline constexpr std::size_t kMapEntries = 8;

/// The communication and mapping parameters of one PDO as they stand.
struct PdoSettings {
  std::uint32_t cob_id = kPdoDisabled;
  std::uint8_t type = 255;
  std::uint16_t inhibit = 0;  ///< in PdoRules::inhibit_unit
  std::uint16_t event = 0;    ///< ms
  std::uint8_t sync_start = 0;
  std::uint8_t count = 0;
  std::array<std::uint32_t, kMapEntries> map{};

  [[nodiscard]] bool enabled() const noexcept { return (cob_id & kPdoDisabled) == 0; }
  [[nodiscard]] std::uint32_t id() const noexcept { return cob_id & 0x7FFU; }
};

/// What all PDOs of a drive work with.
struct PdoContext {
  boost::asio::any_io_executor executor;
  std::uint8_t node = 0;
  ObjectDictionary& dictionary;
  Record& record;
  PdoRules rules;
  std::function<NmtState()> state;
  std::function<bool()> local;  ///< Controlled at the drive: RPDOs have no effect.
  std::function<void(const canopen::Frame&)> send;
  std::function<void(std::uint8_t number, const canopen::Frame&)> received;  ///< after the objects were written
  std::function<void(std::uint8_t number, bool too_long)> length_error;
  std::function<void(std::uint8_t number)> length_right;  ///< a frame of the right length was processed
  std::function<void(std::uint8_t number)> deadline_missed;
};

/// A mapping entry: index, sub-index, length in bits.
struct MapEntry {
  Address address;
  std::uint8_t bits = 0;
};
[[nodiscard]] constexpr MapEntry map_entry(std::uint32_t value) noexcept {
  return {{static_cast<std::uint16_t>(value >> 16U), static_cast<std::uint8_t>(value >> 8U)},
          static_cast<std::uint8_t>(value)};
}
[[nodiscard]] constexpr std::uint32_t map_value(std::uint16_t index, std::uint8_t sub, std::uint8_t bits) noexcept {
  return static_cast<std::uint32_t>(index) << 16U | static_cast<std::uint32_t>(sub) << 8U | bits;
}

/// Whether the object may be mapped in that direction and has that length.
[[nodiscard]] Abort check_entry(ObjectDictionary& dictionary, std::uint32_t value, bool transmit);
/// Whether the first `count` entries may form a PDO.
[[nodiscard]] Abort check_map(ObjectDictionary& dictionary, const PdoSettings& settings, std::uint8_t count,
                              bool transmit);
/// Bytes of the mapped objects.
[[nodiscard]] std::uint8_t mapped_bytes(const PdoSettings& settings);
/// The frame of a TPDO with the objects' values now; nothing when nothing is mapped.
[[nodiscard]] std::optional<canopen::Frame> pack(ObjectDictionary& dictionary, const PdoSettings& settings);
/// Writes the objects of an RPDO; `frame` has at least mapped_bytes().
void unpack(ObjectDictionary& dictionary, const PdoSettings& settings, const canopen::Frame& frame);

}  // namespace simulator
