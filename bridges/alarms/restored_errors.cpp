#include "bridges/alarms/restored_errors.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "bridges/alarms/fault_naming.h"
#include "canopen/node/emcy.h"

namespace alarms {

using config::Severity;

namespace {

Severity severity_of(const config::Drive& model, const AlarmError& error) {
  const auto known = model.faults.drive_texts.find(drive_code_of(model, error).value_or(0));
  if (known != model.faults.drive_texts.end()) {
    return known->second.severity;
  }
  if (error.code == 0) {  // Raised from a bit.
    const bool warning = error.text == name_fault_code(model.faults, model.node.emcy, 0, Severity::warning).text;
    return warning ? Severity::warning : Severity::fault;
  }
  const config::FaultText* const text = config::find_emcy_text(model.faults, error.code);
  return text != nullptr ? text->severity : Severity::fault;
}

}  // namespace

std::vector<AlarmError> restored_errors(const config::Drive& model, const Alarm& before) {
  std::vector<AlarmError> errors = before.errors;
  if (errors.empty()) {
    errors.push_back({before.code, before.vendor, before.text, before.severity, before.since});
  }
  const auto head = std::find_if(errors.rbegin(), errors.rend(), [&](const AlarmError& error) {
    return error.code == before.code && error.text == before.text;
  });
  if (before.severity != Severity::fault || head == errors.rend()) {
    return errors;
  }
  std::for_each(errors.rbegin(), head, [](AlarmError& error) { error.severity = Severity::warning; });
  std::for_each(std::next(head), errors.rend(), [&](AlarmError& error) { error.severity = severity_of(model, error); });
  return errors;
}

std::optional<std::uint64_t> drive_code_of(const config::Drive& model, const AlarmError& error) {
  std::array<std::uint8_t, 8> bytes{static_cast<std::uint8_t>(error.code), static_cast<std::uint8_t>(error.code >> 8)};
  std::copy(error.vendor.begin(), error.vendor.end(), bytes.begin() + 3);
  const std::optional<canopen::Emcy> emcy = canopen::decode_emcy(model.node.emcy, bytes);
  return emcy ? emcy->drive_code : std::nullopt;
}

}  // namespace alarms
