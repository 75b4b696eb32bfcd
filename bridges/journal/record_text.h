#pragma once

#include <string>

#include "bridges/process/command.h"
#include "bridges/process/command_journal.h"
#include "canopen/clock.h"

// The members of a line, in JSON without braces.

namespace journal {

/// Who commands what: `"writer":"modbus","from":"192.0.2.7","drive":"pump1"`.
[[nodiscard]] std::string who_text(const process::CommandRecord& record);
/// What it is about: `"id":"…","fields":[…]`.
[[nodiscard]] std::string what_text(const process::CommandRecord& record);
/// `ok`, or the code of the answer.
[[nodiscard]] std::string code_of(const process::Outcome& outcome);
/// What came of it beside the code: `"ms":12,"error":"…"`.
[[nodiscard]] std::string result_text(const process::CommandRecord& record, const process::Outcome& outcome,
                                      canopen::TimePoint now);

}  // namespace journal
