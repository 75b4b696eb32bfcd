#pragma once

#include <functional>
#include <variant>

#include "bridges/process/image.h"
#include "canopen/error.h"
#include "canopen/object.h"

namespace process {

/// What became of a command.
using Outcome = canopen::Result<void>;

/// One signal of a command. A raw value comes from a Modbus register (already in the signal's type, sign-extended), a
/// number in engineering units from everywhere else.
struct FieldWrite {
  SignalId signal = 0;
  std::variant<canopen::Raw, double> value;
};

/// Whether what a command was made from still stands, as in canopen/still_stands.h.
using StillStands = std::function<bool()>;

}  // namespace process
