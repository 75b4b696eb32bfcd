#include "bridges/alarms/fault_naming.h"

#include <algorithm>
#include <array>
#include <string>

#include "canopen/hex.h"

namespace alarms {
namespace {

using canopen::EmcyLayout;
using config::FaultText;
using config::Severity;

FaultText name_drive_code(const config::FaultRules& rules, std::uint64_t code) {
  const auto known = rules.drive_texts.find(code);
  if (known != rules.drive_texts.end()) {
    return known->second;
  }
  return {"drive fault " + std::to_string(code), Severity::fault};
}

FaultText name_emcy_code(const config::FaultRules& rules, std::uint16_t code) {
  if (const FaultText* known = config::find_emcy_text(rules, code)) {
    return *known;
  }
  return {"emergency 0x" + canopen::hex(code, 4), Severity::fault};
}

}  // namespace

FaultText name_emcy(const config::FaultRules& rules, const canopen::EmcySettings& settings, const canopen::Emcy& emcy) {
  // A number of 0 names nothing; then the EMCY code has to do.
  if (emcy.drive_code.value_or(0) == 0) {
    return name_emcy_code(rules, emcy.code);
  }
  FaultText named = name_drive_code(rules, *emcy.drive_code);
  const bool known = rules.drive_texts.contains(*emcy.drive_code);
  if (!known && settings.layout == EmcyLayout::class_and_vendor40) {
    if (const FaultText* code_class = config::find_emcy_text(rules, emcy.code)) {
      named.text += " (" + code_class->text + ")";
      named.severity = code_class->severity;
    }
  }
  return named;
}

bool is_emcy_code(const config::FaultRules& rules, const canopen::EmcySettings& settings, std::uint64_t code) noexcept {
  return settings.layout == EmcyLayout::cia301 && settings.drive_code_under == 0 && !rules.drive_texts.contains(code) &&
         code <= 0xFFFF;
}

FaultText name_fault_code(const config::FaultRules& rules, const canopen::EmcySettings& settings, std::uint64_t code,
                          Severity severity) {
  if (code == 0) {
    return {severity == Severity::fault ? "drive reports a fault" : "drive reports a warning", severity};
  }
  FaultText named = is_emcy_code(rules, settings, code) ? name_emcy_code(rules, static_cast<std::uint16_t>(code))
                                                        : name_drive_code(rules, code);
  named.severity = severity;
  return named;
}

FaultText name_history_code(const config::FaultRules& rules, const canopen::EmcySettings& settings, std::uint16_t code,
                            Severity severity) {
  if (settings.layout == EmcyLayout::drive_code) {
    return name_fault_code(rules, settings, code, severity);
  }
  FaultText named = name_emcy_code(rules, code);
  named.severity = severity;
  return named;
}

std::optional<std::uint64_t> drive_code_of(const canopen::EmcySettings& settings, const AlarmError& error) {
  std::array<std::uint8_t, 8> bytes{static_cast<std::uint8_t>(error.code), static_cast<std::uint8_t>(error.code >> 8)};
  std::copy(error.vendor.begin(), error.vendor.end(), bytes.begin() + 3);
  const std::optional<canopen::Emcy> emcy = canopen::decode_emcy(settings, bytes);
  return emcy ? emcy->drive_code : std::nullopt;
}

}  // namespace alarms
