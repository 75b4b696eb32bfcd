#include "canopen/node/emcy.h"

#include <algorithm>
#include <cstddef>

namespace canopen {
namespace {

constexpr std::size_t kCodeAndRegister = 3;

std::uint64_t little_endian(std::span<const std::uint8_t> bytes) noexcept {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    number |= std::uint64_t{bytes[i]} << (8 * i);
  }
  return number;
}

// CiA 301 table 26: 0x00xx is "error reset or no error". A drive's own code knows only 0: fault 0x0004 of the AC300 is
// an overcurrent.
bool is_reset(EmcyLayout layout, std::uint16_t code) noexcept {
  return layout == EmcyLayout::drive_code ? code == 0 : (code & 0xFF00) == 0;
}

std::optional<std::uint64_t> drive_code(const EmcySettings& settings, const Emcy& emcy) noexcept {
  switch (settings.layout) {
    case EmcyLayout::drive_code:
      return emcy.code;
    case EmcyLayout::class_and_vendor40:
      return little_endian(emcy.vendor);
    case EmcyLayout::cia301:
      break;
  }
  if (settings.drive_code_under == 0 || emcy.code != settings.drive_code_under) {
    return std::nullopt;
  }
  // Neither width nor order of "drive fault code(s)" is documented (DPD01091 p. 13). One that fits the first two bytes
  // is taken as a number; where the others are used too there may be several, and the bytes are all that can be told.
  const std::uint64_t number = little_endian(emcy.vendor);
  return number <= 0xFFFF ? std::optional(number) : std::nullopt;
}

}  // namespace

std::optional<Emcy> decode_emcy(const EmcySettings& settings, std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() < kCodeAndRegister) {
    return std::nullopt;
  }
  Emcy emcy;
  emcy.code = static_cast<std::uint16_t>(little_endian(bytes.first(2)));
  emcy.error_register = bytes[2];
  const auto vendor = bytes.subspan(kCodeAndRegister);
  std::copy_n(vendor.begin(), std::min(vendor.size(), emcy.vendor.size()), emcy.vendor.begin());
  emcy.reset = is_reset(settings.layout, emcy.code);
  if (!emcy.reset) {
    emcy.drive_code = drive_code(settings, emcy);
  } else if (settings.reset_counts_remaining) {
    emcy.remaining = emcy.vendor[0];
  }
  return emcy;
}

}  // namespace canopen
