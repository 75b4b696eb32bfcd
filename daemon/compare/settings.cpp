#include "daemon/compare/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "canopen/communication_objects.h"
#include "daemon/compare/remedy.h"

namespace gateway::compare {
namespace {

using canopen::DataType;
using canopen::Raw;
using canopen::SetupItem;
using canopen::SetupPolicy;
using config::LiveCheck;
using Level = config::Finding::Level;

void compare_identity_item(DriveView& view, canopen::ObjectAddress object, const std::string& name,
                           const std::optional<std::uint32_t>& wanted) {
  if (wanted) {
    view.compare({object, DataType::u32, *wanted, name, SetupPolicy::verify}, Level::error,
                 "; it is another device than the configuration says: look whether the node id is that of another "
                 "drive, and correct [drive.identity] where the drive was exchanged on purpose");
  }
}

// The drive has the signal and takes commands.
bool commands_it(const config::Drive& drive, const std::string& signal) {
  const auto id = drive.find(signal);
  return drive.commands.writers.any() && id && config::writable(drive.signals[*id].access);
}

// Where it stands, or is set, at the drive itself.
std::string at_the_keypad(const LiveCheck& check, std::string_view otherwise) {
  std::string text = check.keypad.empty() ? std::string(otherwise) : "; at the keypad: " + check.keypad;
  if (!check.unconfirmed.empty()) {
    text += " (unconfirmed: " + check.unconfirmed + ")";
  }
  return text;
}

std::string raw_text(const LiveCheck& check, Raw raw) {
  return check.mask != ~Raw{0} ? fmt::format("0x{:X}", raw & check.mask)
                               : fmt::format("{}", canopen::to_number(check.type, raw));
}

void compare_values(DriveView& view, const LiveCheck& check, Raw found) {
  const auto is_found = [&](Raw right) {
    return (canopen::normalise(check.type, right) & check.mask) == (found & check.mask);
  };
  if (std::ranges::any_of(check.equals, is_found)) {
    view.as_it_should();
    return;
  }
  std::string right;
  for (const Raw value : check.equals) {
    right += (right.empty() ? "" : " or ") + raw_text(check, value);
  }
  view.note(Level::warning, fmt::format("{} {}: expected {}, found {}{}", canopen::to_string(check.object), check.name,
                                        right, raw_text(check, found), at_the_keypad(check, "")));
}

// The greatest amount that may be commanded, of either sign.
std::optional<double> greatest_of(const config::Signal& signal) {
  if (!signal.max) {
    return std::nullopt;
  }
  return std::max(std::abs(*signal.max), signal.min ? std::abs(*signal.min) : 0.0);
}

void compare_limit(DriveView& view, const LiveCheck& check, Raw found) {
  const config::Signal& signal = view.drive().signals[*view.drive().find(check.limits)];
  const std::optional<double> greatest = greatest_of(signal);
  const double limit = canopen::to_number(check.type, found) * check.scale;
  if (!greatest) {
    return;  // Nothing is stated that the drive might cut.
  }
  if (*greatest <= limit + check.scale / 2) {
    view.as_it_should();
    return;
  }
  view.note(Level::warning,
            fmt::format("{} {} is {:.10g} {}, and {} may be commanded up to {:.10g} {}, which the drive cuts or "
                        "refuses; lower max in [drive.signals.{}], or raise the limit{}",
                        canopen::to_string(check.object), check.name, limit, signal.unit, signal.name, *greatest,
                        signal.unit, signal.name, at_the_keypad(check, " in the drive")));
}

void compare_live_check(DriveView& view, const LiveCheck& check) {
  const std::string& needed = check.limits.empty() ? check.signal : check.limits;
  if (!needed.empty() && !commands_it(view.drive(), needed)) {
    return;
  }
  const Reading found = view.read(check.object, check.type, check.name);
  if (found.kind != Reading::Kind::value) {
    return;
  }
  if (check.limits.empty()) {
    compare_values(view, check, found.raw);
  } else {
    compare_limit(view, check, found.raw);
  }
}

}  // namespace

std::string remedy_of(SetupPolicy policy, const config::Drive& drive) {
  switch (policy) {
    case SetupPolicy::write:
      return "; the gateway writes it when it configures the drive: let the motor stand, then `canopen-gateway nmt " +
             drive.name + " reset-communication`";
    case SetupPolicy::verify:
      return "; the gateway only compares it: change it in the drive, or in the configuration";
    case SetupPolicy::assume:
      break;
  }
  return "; the gateway takes it for granted as configured, so change it in the drive, or in the configuration";
}

void compare_identity(DriveView& view) {
  const canopen::ExpectedIdentity& identity = view.drive().node.identity;
  constexpr std::uint16_t kIdentity = canopen::kSerialNumber.index;
  compare_identity_item(view, canopen::kDeviceType, "device type", identity.device_type);
  compare_identity_item(view, {kIdentity, 1}, "vendor", identity.vendor);
  compare_identity_item(view, {kIdentity, 2}, "product", identity.product);
  compare_identity_item(view, {kIdentity, 3}, "revision", identity.revision);
  compare_identity_item(view, canopen::kSerialNumber, "serial number", identity.serial);
}

void compare_setup(DriveView& view) {
  for (const canopen::ObjectValue& value : view.drive().node.setup) {
    view.compare({value.object, value.type, value.raw, "setup", SetupPolicy::write}, Level::error,
                 remedy_of(SetupPolicy::write, view.drive()));
  }
}

void compare_live_checks(DriveView& view, const config::DriveNotes& notes) {
  for (const LiveCheck& check : notes.live) {
    compare_live_check(view, check);
  }
}

}  // namespace gateway::compare
