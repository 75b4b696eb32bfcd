#pragma once

#include <cstddef>
#include <system_error>

#include "canopen/socketcan/descriptor.h"

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

}  // namespace canopen::socketcan
