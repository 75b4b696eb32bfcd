#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridges/process/command.h"
#include "bridges/process/write_plan.h"
#include "bridges/process/writer.h"
#include "canopen/error.h"
#include "canopen/object.h"
#include "config/model.h"

// What can be said of a command by the configuration alone.

namespace process {

/// `forbidden` where the drive takes no commands of this kind of writer.
[[nodiscard]] std::optional<canopen::Error> refuse_writer(const config::Drive& model, const Writer& writer);

/// `forbidden` for an SDO write of an object that is no writable signal: without `raw`, and of what sets up PDOs in any
/// case, since the meaning of every command hangs on it.
[[nodiscard]] std::optional<canopen::Error> refuse_raw(const config::Drive& model, canopen::ObjectAddress object);

/// The raw value of a field, checked and rounded. Bits alone are no value: the arbiter makes one of them before.
[[nodiscard]] canopen::Result<canopen::Raw> check_given(const config::Signal& signal, const FieldWrite& write);

/// Limits of the site do not make a stop less of a stop.
[[nodiscard]] config::Signal without_limits(const config::Signal& signal);

/// All of them checked and rounded to raw values, or the first error: access, type, range. Of several fields the error
/// names its own.
[[nodiscard]] canopen::Result<std::vector<Field>> check_fields(const config::Drive& model,
                                                               const std::vector<FieldWrite>& fields);

/// The signal through which an object is written, where there is one.
[[nodiscard]] std::optional<SignalId> writable_signal(const config::Drive& model, canopen::ObjectAddress object);

/// The same error, naming the signals that were written before it.
[[nodiscard]] canopen::Error with_written(canopen::Error error, const std::string& names);

/// What a drive answers that does not take a mapped object by SDO at all.
[[nodiscard]] bool takes_no_sdo(const canopen::Error& error) noexcept;

[[nodiscard]] canopen::Error command_error(const config::Drive& model, canopen::ErrorKind kind, std::string detail);

}  // namespace process
