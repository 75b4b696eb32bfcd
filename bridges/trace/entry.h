#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "bridges/trace/kind.h"
#include "canopen/bus/frame_tap.h"
#include "canopen/clock.h"
#include "canopen/frame.h"
#include "canopen/object.h"

namespace trace {

/// What one frame of an SDO does (CiA 301 §7.2.4.3).
enum class SdoStep : std::uint8_t {
  unclear,            ///< No frame of an SDO, or none that fits to the ones before.
  read,               ///< Client: asks for an object.
  write,              ///< Client: an object, with its value.
  write_begin,        ///< Client: an object, whose value follows in segments.
  write_segment,      ///< Client.
  ask_segment,        ///< Client: the next segment, please.
  value,              ///< Server: the value that was asked for.
  value_begin,        ///< Server: it follows in segments.
  value_segment,      ///< Server.
  written,            ///< Server: it has the value.
  segment_taken,      ///< Server.
  block_read,         ///< Client: asks for an object in blocks.
  block_read_ready,   ///< Server.
  block_read_start,   ///< Client: go on.
  block_write,        ///< Client: an object, whose value follows in blocks.
  block_write_ready,  ///< Server.
  block_segment,      ///< Whoever has the value.
  block_taken,        ///< The other one.
  block_end,          ///< Whoever had the value.
  block_end_taken,    ///< The other one.
  abort               ///< Either.
};

/// One frame of an SDO, with what the frames before it tell of it.
struct SdoPart {
  static constexpr std::size_t kKept = 48;  ///< Bytes of a value; of a longer one only its length is told.

  SdoStep step = SdoStep::unclear;
  bool by_server = false;
  bool knows_object = false;  ///< The frame names it, or the ones before it did.
  bool last = false;          ///< Of segments.
  canopen::ObjectAddress object{};
  std::uint8_t number = 0;  ///< Of a block's segments.
  std::uint32_t abort = 0;  ///< The code.
  std::uint32_t bytes = 0;  ///< Announced, of this segment, or, with a value, of the whole value; 0: not told.
  std::uint8_t kept = 0;    ///< Bytes of `data`; a whole value only where it is `bytes`.
  std::array<std::uint8_t, kKept> data{};  ///< Of a value that is complete with this frame.

  [[nodiscard]] std::span<const std::uint8_t> value() const noexcept { return {data.data(), kept}; }
};

enum class PdoWay : std::uint8_t { transmit, receive };

/// One frame of a bus, taken apart: plain values, no text, no memory of its own. What it means in words depends on
/// nothing but this and the model.
struct Entry {
  canopen::Frame frame;
  canopen::WallTime at{};
  canopen::FrameOrigin origin = canopen::FrameOrigin::others;
  Kind kind = Kind::other;
  std::optional<std::uint16_t> bus{};    ///< Position in Model::buses; nothing: none of them.
  std::optional<std::uint16_t> drive{};  ///< Position in Model::drives; nothing: none of them.
  std::uint8_t node = 0;                 ///< That it comes from or is for; 0: none, of NMT all.
  std::uint16_t pdo = 0;                 ///< Its number.
  PdoWay way = PdoWay::transmit;
  std::optional<std::uint16_t> mapping{};  ///< Position in the drive's tpdos or rpdos; nothing: not in its profile.
  bool guarded = false;                    ///< The answer to a guarding request.
  SdoPart sdo{};
  std::uint32_t lost = 0;  ///< >0: no frame; so many at least were lost on the way here.
  bool gone = false;       ///< Of a bus that is not configured any more: nobody is shown it.
};

}  // namespace trace
