#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "canopen/node/node_settings.h"
#include "canopen/sdo/expedited.h"

// Where real SDO servers depart from CiA 301, and what is tolerated. Everything here is about answers: our requests
// always follow the standard.

namespace canopen {

/// CiA 301 §7.2.4.3: every SDO frame has 8 bytes. AC300CAN1 cuts its answers after the last byte that means something
/// (`60 30 20 07`, `4b 21 20 1B DC 00`); SdoSettings::accept_short_answers takes them if all `needed` bytes are there.
[[nodiscard]] bool long_enough(const SdoSettings& settings, std::span<const std::uint8_t> answer,
                               std::size_t needed) noexcept;

/// How many bytes of an expedited answer are data. Without a size bit (0x42) the dictionary decides: `expected`, the
/// bytes of the object's type; 0: not known, then all four.
[[nodiscard]] std::size_t expedited_length(const UploadAnswer& answer, std::size_t expected) noexcept;

/// An answer that confirms a write: 0x60, and with SdoSettings::accept_upload_style_write_answer also 0x43, 0x47, 0x4B
/// or 0x4F (AC300CAN1's F02.02 example).
[[nodiscard]] bool confirms_write(const SdoSettings& settings, std::span<const std::uint8_t> answer) noexcept;

}  // namespace canopen
