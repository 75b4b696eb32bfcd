#pragma once

#include <string>
#include <string_view>

#include "config/toml/report.h"

// The three descriptors that a program is born with, as whoever started it left them.

namespace gateway {

/// Opens /dev/null for those of 0, 1 and 2 that are closed; else the next sockets would get these numbers, and what is
/// printed would go into them. To be called before anything else is opened. @throws std::system_error
void open_missing_descriptors();

/// What is written there goes to the journal: JOURNAL_STREAM names its device and inode (systemd.exec(5)).
[[nodiscard]] bool is_journal(int descriptor);

/// The text as it is written to this descriptor: on the journal each line begins with its priority (sd-daemon(3)),
/// `<3>` for errors and `<4>` for warnings.
[[nodiscard]] std::string with_priority(int descriptor, config::Finding::Level level, std::string_view text);

/// Writes `canopen-gateway: ` and an error to standard error, a line.
void complain(std::string_view error);

}  // namespace gateway
