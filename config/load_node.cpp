#include <algorithm>

#include "config/drive_draft.h"
#include "config/reader.h"
#include "config/text.h"

namespace config {
namespace {

canopen::SetupPolicy policy_of(const Node& table, std::string_view key, canopen::SetupPolicy standard) {
  const auto text = read_text(table, key);
  if (text == "verify") {
    return canopen::SetupPolicy::verify;
  }
  if (text == "assume") {
    return canopen::SetupPolicy::assume;
  }
  return text == "write" ? canopen::SetupPolicy::write : standard;
}

void read_error_control(DriveDraft& draft) {
  canopen::ErrorControlSettings& control = draft.drive.node.error_control;
  bool consumer = false;
  if (const Node* const table = read_table(draft.merged, "error_control"); table != nullptr) {
    control.policy = policy_of(*table, "policy", control.policy);
    take(control.has_guarding, read_boolean(*table, "guarding"));
    take(consumer, read_boolean(*table, "consumer"));
  }
  if (control.supervise_gateway != canopen::Duration::zero() && !consumer) {
    draft.error(place_of(draft.site, "supervise_gateway"),
                "profile \"" + draft.drive.profile +
                    "\" cannot supervise the gateway (no 0x1016); leave supervise_gateway out, or, where the drive "
                    "has the object, set error_control.consumer = true");
  }
}

void read_sdo(DriveDraft& draft) {
  const Node* const table = read_table(draft.merged, "sdo");
  if (table == nullptr) {
    return;
  }
  canopen::SdoSettings& sdo = draft.drive.node.sdo;
  take(sdo.timeout, read_duration(*table, "timeout"));
  take(sdo.retries, read_as<unsigned>(*table, "retries"));
  take(sdo.accept_short_answers, read_boolean(*table, "short_answers"));
  take(sdo.accept_upload_style_write_answer, read_boolean(*table, "upload_style_write_answer"));
}

void read_emcy(DriveDraft& draft) {
  const Node* const table = read_table(draft.merged, "emcy");
  if (table == nullptr) {
    return;
  }
  canopen::EmcySettings& emcy = draft.drive.node.emcy;
  const auto layout = read_text(*table, "layout");
  if (layout == "drive-code") {
    emcy.layout = canopen::EmcyLayout::drive_code;
  } else if (layout == "class-and-vendor40") {
    emcy.layout = canopen::EmcyLayout::class_and_vendor40;
  }
  take(emcy.reset_counts_remaining, read_boolean(*table, "reset_counts_remaining"));
  take(emcy.drive_code_under, read_as<std::uint16_t>(*table, "drive_code_under"));
  take(draft.drive.faults.has_error_register, read_boolean(*table, "error_register"));
  take(draft.drive.faults.has_error_field, read_boolean(*table, "error_field"));
}

void read_identity(DriveDraft& draft) {
  const Node* const table = read_table(draft.merged, "identity");
  if (table == nullptr) {
    return;
  }
  canopen::ExpectedIdentity& identity = draft.drive.node.identity;
  identity.device_type = read_as<std::uint32_t>(*table, "device_type");
  identity.vendor = read_as<std::uint32_t>(*table, "vendor");
  identity.product = read_as<std::uint32_t>(*table, "product");
  identity.revision = read_as<std::uint32_t>(*table, "revision");
  identity.serial = read_as<std::uint32_t>(*table, "serial");
}

/// Nothing that could move a motor is written at boot.
bool is_commanding(const Node& merged, canopen::ObjectAddress object) {
  for (const Entry& entry : merged.entries) {
    if (!entry.key.starts_with("rpdo")) {
      continue;
    }
    const auto map = read_texts(entry.value, "map");
    if (std::any_of(map.begin(), map.end(), [object](const Node* item) {
          const auto mapped = parse_mapped(item->text);
          return mapped.has_value() && mapped->first == object;
        })) {
      return true;
    }
  }
  const Node* const signals = read_table(merged, "signals");
  if (signals == nullptr) {
    return false;
  }
  return std::any_of(signals->entries.begin(), signals->entries.end(), [object](const Entry& entry) {
    return read_object(entry.value, "object") == object && read_text(entry.value, "access") == "write";
  });
}

void read_setup(DriveDraft& draft) {
  for (const Node* const item : read_tables(draft.merged, "setup")) {
    const auto object = read_object(*item, "object");
    const auto type = read_type(*item, "type");
    const auto value = read_integer(*item, "value");
    if (!object.has_value() || !type.has_value() || !value.has_value()) {
      continue;
    }
    const auto raw = static_cast<canopen::Raw>(*value);
    const std::string where = "setup of " + canopen::to_string(*object) + ": ";
    if (canopen::is_real(*type)) {
      draft.error(place_of(*item, "type"), where + "only integers can be written at boot");
    } else if (canopen::normalise(*type, raw) != raw || (!canopen::is_signed(*type) && *value < 0)) {
      draft.error(place_of(*item, "value"),
                  where + "value " + std::to_string(*value) + " does not fit " + std::string(canopen::name_of(*type)));
    } else if (is_commanding(draft.merged, *object)) {
      draft.error(place_of(*item, "object"), where + "it is a command, and no command is given at boot");
    } else {
      draft.drive.node.setup.push_back({.object = *object, .type = *type, .raw = raw});
    }
  }
}

FaultText fault_of(const Node& value) {
  if (value.kind == NodeKind::table) {
    return {.text = read_text(value, "text").value_or(""),
            .severity = read_text(value, "severity") == "warning" ? Severity::warning : Severity::fault};
  }
  return {.text = value.text};
}

void read_texts(DriveDraft& draft) {
  FaultRules& faults = draft.drive.faults;
  for (const auto& [number, entry] : read_numbered(draft.merged, "fault_texts")) {
    faults.drive_texts.insert_or_assign(static_cast<std::uint64_t>(number), fault_of(entry->value));
  }
  for (const auto& [number, entry] : read_numbered(draft.merged, "emcy_texts")) {
    faults.emcy_texts.insert_or_assign(static_cast<std::uint16_t>(number), fault_of(entry->value));
  }
}

}  // namespace

void read_node_settings(DriveDraft& draft) {
  read_error_control(draft);
  read_sdo(draft);
  read_emcy(draft);
  read_identity(draft);
  read_setup(draft);
  read_texts(draft);
}

}  // namespace config
