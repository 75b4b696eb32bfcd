#pragma once

#include <string>

#include "bridges/trace/entry.h"
#include "config/model.h"

// What a frame says, in words for people. `model` is the one that the decoder had.

namespace trace {

/// `heartbeat`, `SDO`, `TPDO1`: short, and the same for each frame of its kind.
[[nodiscard]] std::string heading_of(const Entry& entry);
/// The drive, else `node 9`, `gateway`, `all`; empty: nobody's.
[[nodiscard]] std::string owner_of(const config::Model& model, const Entry& entry);
/// What it means.
[[nodiscard]] std::string words_of(const config::Model& model, const Entry& entry);

/// Parts of words_of().
[[nodiscard]] std::string sdo_words(const config::Drive* drive, const Entry& entry);
[[nodiscard]] std::string pdo_words(const config::Drive* drive, const Entry& entry);
[[nodiscard]] std::string emcy_words(const config::Drive* drive, const Entry& entry);
/// Of an error frame of the driver (linux/can/error.h).
[[nodiscard]] std::string error_words(const canopen::Frame& frame);

}  // namespace trace
