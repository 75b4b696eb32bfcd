#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

namespace canopen::socketcan {

using Bytes = std::span<const std::uint8_t>;

/// Netlink pads everything to four bytes, in the sender's own byte order; so every structure is copied out. Nothing
/// where there are too few bytes.
template <class T>
[[nodiscard]] std::optional<T> read_at(Bytes bytes, std::size_t offset = 0) {
  T value{};
  if (bytes.size() < offset + sizeof value) {
    return std::nullopt;
  }
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace canopen::socketcan
