#include "bridges/process/stop_check.h"

#include <algorithm>

#include "bridges/process/command_checks.h"

namespace process {

bool is_stop(const config::Drive& model, const config::Signal& control, canopen::Raw word) noexcept {
  return canopen::is_stop(model.node.motor, word) && !config::is_momentary(control, word);
}

bool is_stop(const config::Drive& model, std::span<const FieldWrite> fields) {
  const auto control = model.find("control_command");
  if (!control) {
    return false;
  }
  const auto written =
      std::find_if(fields.rbegin(), fields.rend(), [&](const FieldWrite& field) { return field.signal == *control; });
  if (written == fields.rend()) {
    return false;
  }
  const config::Signal& signal = model.signals[*control];
  const canopen::Result<canopen::Raw> raw = check_given(without_limits(signal), *written);
  return raw.has_value() && is_stop(model, signal, raw.value());
}

}  // namespace process
