#pragma once

#include "canopen/clock.h"

namespace canopen {

/// What an SDO client has to know of its node.
struct SdoSettings {
  Duration timeout = std::chrono::milliseconds(500);  ///< Of one answer frame.
  unsigned retries = 2;               ///< Further tries of reads and boot writes. A command's SDO is sent once.
  Duration patience{};                ///< How long after a boot-up the server may be silent; zero: not at all.
  bool block = false;                 ///< What is long goes by block transfer, where the node knows it.
  bool accept_short_answers = false;  ///< Answers that end after the bytes their command needs (AC300CAN1).
  bool accept_upload_style_write_answer = false;  ///< 0x4B with the same object confirms a write (AC300CAN1).
  friend bool operator==(const SdoSettings&, const SdoSettings&) = default;
};

}  // namespace canopen
