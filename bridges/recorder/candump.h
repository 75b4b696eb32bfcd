#pragma once

#include <string>
#include <string_view>

#include "bridges/recorder/frame_ring.h"

namespace recorder {

/// One line as `candump -l` writes it, `(1767323045.678000) can0 185#2702000000000000`; nothing for a gap. An error
/// frame has the flag CAN_ERR_FLAG in its identifier, a remote request `R` and its length.
void append_candump(std::string& out, std::string_view interface, const KeptFrame& frame);

}  // namespace recorder
