#include <algorithm>

#include "config/drive/builder.h"
#include "config/text.h"
#include "config/toml/document.h"

namespace config {
namespace {

/// Nothing that could move a motor is written at boot.
bool is_commanding(const OverlayKeys& said, canopen::ObjectAddress object) {
  const auto maps = [object](const Said<PdoKeys>& rpdo) {
    const auto& map = rpdo.keys.map;
    return std::any_of(map.begin(), map.end(), [object](const auto& mapped) { return mapped.first == object; });
  };
  const auto writes = [object](const Said<SignalKeys>& signal) {
    return signal.keys.object == object && signal.keys.signal.access == Access::write;
  };
  return std::any_of(said.rpdos.begin(), said.rpdos.end(), maps) ||
         std::any_of(said.signals.begin(), said.signals.end(), writes);
}

void take_setup(DriveDraft& draft) {
  for (const Said<SetupKeys>& item : draft.said.setup) {
    const auto& [object, type, value] = item.keys;
    if (!object.has_value() || !type.has_value() || !value.has_value()) {
      continue;
    }
    const auto raw = static_cast<canopen::Raw>(*value);
    const std::string where = "setup of " + canopen::to_string(*object) + ": ";
    if (canopen::is_real(*type)) {
      draft.error(place_of(item, "type"), where + "only integers can be written at boot");
    } else if (canopen::normalise(*type, raw) != raw || (!canopen::is_signed(*type) && *value < 0)) {
      draft.error(place_of(item, "value"),
                  where + "value " + std::to_string(*value) + " does not fit " + std::string(canopen::name_of(*type)));
    } else if (is_commanding(draft.said, *object)) {
      draft.error(place_of(item, "object"), where + "it is a command, and no command is given at boot");
    } else {
      draft.drive.node.setup.push_back({.object = *object, .type = *type, .raw = raw});
    }
  }
}

void take_error_control(DriveDraft& draft) {
  const ErrorControlKeys& said = draft.said.error_control;
  canopen::ErrorControlSettings& control = draft.drive.node.error_control;
  const std::string profile = "profile \"" + draft.drive.profile + "\" ";
  control.policy = said.policy;
  control.has_guarding = said.guarding;
  if (control.guarding != canopen::Duration::zero()) {
    if (!said.guarding) {
      draft.error(place_of(draft.site, "guarding"),
                  profile +
                      "does not answer node guarding; leave guarding out, or, where the drive has it, set "
                      "error_control.guarding = true");
    }
  } else if (control.supervise_gateway != canopen::Duration::zero() && !said.consumer) {
    draft.error(place_of(draft.site, "supervise_gateway"),
                profile +
                    "cannot supervise the gateway (no 0x1016); leave supervise_gateway out, or, where the drive "
                    "has the object, set error_control.consumer = true");
  }
}

}  // namespace

void take_node_settings(DriveDraft& draft) {
  const OverlayKeys& said = draft.said;
  canopen::NodeSettings& node = draft.drive.node;
  take_error_control(draft);
  node.sdo = said.sdo;
  node.emcy = said.emcy.settings;
  node.identity = said.identity;
  node.self_starting = said.self_starting;
  FaultRules& faults = draft.drive.faults;
  faults.has_error_register = said.emcy.error_register;
  faults.error_register_follows = said.error_register;
  faults.has_error_field = said.emcy.error_field;
  for (const auto& [code, text] : said.fault_texts) {
    faults.drive_texts.insert_or_assign(static_cast<std::uint64_t>(code), text);
  }
  for (const auto& [code, text] : said.emcy_texts) {
    faults.emcy_texts.insert_or_assign(static_cast<std::uint16_t>(code), text);
  }
  take_setup(draft);
}

}  // namespace config
