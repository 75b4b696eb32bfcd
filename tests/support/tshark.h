#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "canopen/bus/link.h"

namespace support {

/// What tshark says of a frame.
struct Decoded {
  std::string frame;  ///< As it stands in candump's log: `605#4018100400000000`.
  bool malformed = false;
  std::string info;  ///< `Default-SDO (rx): Initiate upload request`.
};

/// A log in candump's form in place of frames; Decoded::frame is empty. Nothing where tshark cannot read it.
[[nodiscard]] std::vector<Decoded> decode_log_by_tshark(const std::filesystem::path& log);

/// Has tshark decode the frames as CANopen, in order. It knows nothing of our code, and nothing of the frames before: a
/// segment of a block transfer, which has no command, is taken for whatever its first byte would mean elsewhere.
/// Throws std::runtime_error where tshark does not run.
[[nodiscard]] std::vector<Decoded> decode_by_tshark(std::span<const canopen::Received> frames);

}  // namespace support
