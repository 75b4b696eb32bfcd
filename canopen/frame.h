#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace canopen {

/// The largest 11-bit identifier; CANopen uses no 29-bit ones (CiA 301 §7.1).
inline constexpr std::uint32_t kMaxCobId = 0x7FF;

/// A classic CAN frame as plain data, free of the operating system's layout.
struct Frame {
  std::uint32_t id = 0;   ///< COB-ID without flags; for an error frame its error class bits.
  std::uint8_t size = 0;  ///< Data bytes used, 0..8.
  bool extended = false;  ///< 29-bit identifier; never CANopen.
  bool remote = false;    ///< Remote request (RTR), carries no data.
  bool error = false;     ///< Made by the controller's driver, never seen on the wire.
  std::array<std::uint8_t, 8> data{};

  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept { return {data.data(), size}; }

  friend bool operator==(const Frame&, const Frame&) = default;
};

/// A data frame of `bytes`, of which at most 8 are taken.
[[nodiscard]] constexpr Frame make_frame(std::uint32_t cob_id, std::span<const std::uint8_t> bytes) noexcept {
  Frame frame;
  frame.id = cob_id;
  for (std::size_t i = 0; i < bytes.size() && i < frame.data.size(); ++i) {
    frame.data[i] = bytes[i];
    frame.size = static_cast<std::uint8_t>(i + 1);
  }
  return frame;
}

}  // namespace canopen
