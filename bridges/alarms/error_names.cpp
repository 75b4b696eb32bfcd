#include "bridges/alarms/error_names.h"

#include <algorithm>
#include <array>
#include <utility>

#include "bridges/alarms/fault_naming.h"

namespace alarms {
namespace {

using config::Severity;

std::uint16_t short_code(std::uint64_t code) noexcept {
  return code <= 0xFFFF ? static_cast<std::uint16_t>(code) : std::uint16_t{0};
}

/// Its vendor bytes are those of an emergency.
bool has_vendor_bytes(const ErrorEntry& entry) noexcept {
  const bool any = entry.error.vendor != std::array<std::uint8_t, 5>{};
  return entry.source == ErrorSource::emergency || (entry.source == ErrorSource::memory && any);
}

}  // namespace

AlarmError error_of_code(const config::Drive& model, std::uint64_t code, Severity severity, canopen::WallTime since) {
  return {short_code(code), {}, name_fault_code(model.faults, model.node.emcy, code, severity).text, severity, since};
}

bool is_named(const ErrorEntry& entry, std::uint64_t fault_code) noexcept {
  return entry.drive_code == fault_code || entry.error.code == fault_code;
}

ErrorEntry* find_same(ErrorEntries& entries, std::uint16_t code, const std::array<std::uint8_t, 5>& vendor) noexcept {
  const auto find = [&](auto matches) {
    const auto found = std::find_if(entries.begin(), entries.end(), [&](const ErrorEntry& entry) {
      return entry.error.code == code && matches(entry);
    });
    return found != entries.end() ? &*found : nullptr;
  };
  ErrorEntry* const exact = find([&](const ErrorEntry& entry) { return entry.error.vendor == vendor; });
  return exact != nullptr ? exact : find([](const ErrorEntry& entry) { return !has_vendor_bytes(entry); });
}

bool ErrorNames::on_fault_code(std::uint64_t code, ErrorEntries& entries) {
  if (std::exchange(fault_code_, code) == code || code == 0) {
    return false;
  }
  bool changed = false;
  for (ErrorEntry& entry : entries) {
    const std::uint64_t suited = code_for(entry.error.severity, entries);
    if (entry.source == ErrorSource::signal && suited != 0 && entry.drive_code != suited) {
      entry.error = error_of_code(model_, suited, entry.error.severity, entry.error.since);
      entry.drive_code = suited;
      changed = true;
    }
  }
  return changed;
}

void ErrorNames::on_history(std::uint16_t code, ErrorEntries& entries) const {
  for (ErrorEntry& entry : entries) {
    if (code != 0 && entry.drive_code == 0U && entry.error.code == 0) {
      entry.error.code = code;
      entry.error.text = name_history_code(model_.faults, model_.node.emcy, code, entry.error.severity).text;
    }
  }
}

bool ErrorNames::tabled_as(Severity severity) const noexcept {
  const auto known = model_.faults.drive_texts.find(fault_code_);
  return known != model_.faults.drive_texts.end() && known->second.severity == severity;
}

std::uint64_t ErrorNames::code_for(Severity severity, const ErrorEntries& entries) const noexcept {
  if (severity == Severity::fault) {
    return fault_code_;
  }
  // A drive has one fault code: that of a fault must not name the warning beside it.
  const bool names_fault = !signals_.is_clear(Severity::fault) && tabled_as(Severity::fault);
  const bool taken = std::any_of(entries.begin(), entries.end(), [&](const ErrorEntry& entry) {
    return entry.error.severity == Severity::fault && is_named(entry, fault_code_);
  });
  return names_fault || taken ? 0 : fault_code_;
}

// The one that was active may have gone and another come while nobody listened. The old one stays until something tells
// that it is over: the drive may have both.
bool ErrorNames::is_another_fault(const ErrorEntries& entries) const noexcept {
  const bool may_warn = !signals_.is_clear(Severity::warning);
  if (fault_code_ == 0 || (may_warn && tabled_as(Severity::warning))) {
    return false;
  }
  const bool of_emcy = is_emcy_code(model_.faults, model_.node.emcy, fault_code_);
  return std::all_of(entries.begin(), entries.end(), [&](const ErrorEntry& entry) {
    // Without a number to compare it may be the same.
    const bool comparable = entry.drive_code.value_or(0) != 0 || of_emcy;
    return entry.error.severity != Severity::fault ||
           (entry.from_before && comparable && !is_named(entry, fault_code_));
  });
}

// The makers' tables do not say for certain what is a fault; the drive's signals do. A sample from before the fault
// signal followed may have made a fault a warning: then it goes back.
bool ErrorNames::claim(Severity severity, ErrorEntries& entries) const noexcept {
  const Severity other = severity == Severity::fault ? Severity::warning : Severity::fault;
  const bool needed_as_fault = severity == Severity::warning && signals_.is_set(other);
  bool any = false;
  for (ErrorEntry& entry : entries) {
    const bool its_own = entry.tabled == severity && !needed_as_fault;
    const bool never_shown = signals_.is_clear(other) && !entry.seen_set;
    // 0x1001 does not tell which it is either, and may have been read before any signal came.
    const bool by_table = entry.source == ErrorSource::emergency && its_own;
    const bool unsure = entry.source == ErrorSource::emergency || entry.source == ErrorSource::error_register;
    if (by_table || (unsure && never_shown)) {
      entry.error.severity = severity;
      any = true;
    }
  }
  return any;
}

}  // namespace alarms
