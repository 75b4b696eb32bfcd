#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>

#include "canopen/bus/socketcan/descriptor.h"

namespace canopen::socketcan {

/// About a second of a full bus at 1 Mbit/s: a received frame takes close to a kilobyte in the kernel, which doubles
/// this number for its own bookkeeping.
inline constexpr int kWantedReceiveBuffer = 4 * 1024 * 1024;

struct RawSocket {
  Descriptor descriptor;
  std::error_code error;   ///< Set: there is no descriptor.
  int receive_buffer = 0;  ///< Bytes granted, comparable with kWantedReceiveBuffer.
};

/// A non-blocking CAN RAW socket on the interface with this index, ready for ReceiveBatch.
[[nodiscard]] RawSocket open_raw_socket(int interface_index);

/// For people, where a socket was granted less than kWantedReceiveBuffer; else empty.
[[nodiscard]] std::string small_buffer_notice(int receive_buffer);

/// Something can be read from the socket now: a frame or an error. Takes neither.
[[nodiscard]] bool has_something_to_read(int socket) noexcept;

/// The frames that were dropped on this socket so far: what SO_RXQ_OVFL tells with the next frame. Nothing where the
/// kernel does not say.
[[nodiscard]] std::optional<std::uint32_t> dropped_so_far(int socket) noexcept;

}  // namespace canopen::socketcan
