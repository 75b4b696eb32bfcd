#include <array>

#include "config/schema.h"
#include "config/schema_limits.h"

namespace config {
namespace {

constexpr std::int64_t kMaxU32 = 0xFFFF'FFFF;
constexpr std::string_view kPolicies = "write|verify|assume";

constexpr std::array kPdoKeys{
    Key{.name = "enabled",
        .kind = KeyKind::boolean,
        .standard = "true",
        .meaning = "`false`: the gateway leaves it alone."},
    Key{.name = "cob_id",
        .kind = KeyKind::cob_id,
        .standard = "predefined for 1..4",
        .meaning = "`0x185` or `\"$NODEID+0x180\"`.",
        .min = 1,
        .max = 0x7FF},
    Key{.name = "communication",
        .kind = KeyKind::choice,
        .standard = "write",
        .meaning = "COB-ID, type and times: made so, only compared, or taken for granted.",
        .choices = kPolicies},
    Key{.name = "mapping",
        .kind = KeyKind::choice,
        .standard = "write",
        .meaning = "The same for the mapping.",
        .choices = kPolicies},
    Key{.name = "transmission_type",
        .kind = KeyKind::integer,
        .standard = "as the drive has it",
        .meaning = "Sub-index 2.",
        .min = 0,
        .max = 255},
    Key{.name = "inhibit_time",
        .kind = KeyKind::duration,
        .standard = "as the drive has it",
        .meaning = "Sub-index 3, counted in `inhibit_unit`.",
        .min = 0,
        .max = kMs16},
    Key{.name = "event_timer",
        .kind = KeyKind::duration,
        .standard = "as the drive has it",
        .meaning = "Sub-index 5, whole milliseconds; `0s`: none. Of an RPDO: the drive supervises its arrival.",
        .min = 0,
        .max = kMs16},
    Key{.name = "map",
        .kind = KeyKind::mapping,
        .meaning = "Its objects in order, `\"0x2021:02 u16\"`; at most 64 bits. Replaces the profile's as a whole."},
    Key{.name = "unused",
        .kind = KeyKind::texts,
        .standard = "[]",
        .meaning = "RPDO: signals or objects that the site does not use; sent as 0, and no signal any more."},
    Key{.name = "unconfirmed",
        .kind = KeyKind::boolean,
        .standard = "false",
        .meaning = "The layout is not established for this drive."}};

constexpr std::array kErrorControlKeys{
    Key{.name = "policy",
        .kind = KeyKind::choice,
        .standard = "write",
        .meaning = "Of the heartbeat period, 0x1017.",
        .choices = kPolicies},
    Key{.name = "consumer",
        .kind = KeyKind::boolean,
        .standard = "false",
        .meaning = "It can supervise the gateway's heartbeat (0x1016)."},
    Key{.name = "guarding",
        .kind = KeyKind::boolean,
        .standard = "false",
        .meaning =
            "It answers node guarding; asked once for its state, when found without a heartbeat. Guarding does not "
            "supervise it."}};

constexpr std::array kSdoKeys{Key{.name = "timeout",
                                  .kind = KeyKind::duration,
                                  .standard = "500ms",
                                  .meaning = "Of one answer frame.",
                                  .min = 10 * kMs,
                                  .max = 60'000 * kMs},
                              Key{.name = "retries",
                                  .kind = KeyKind::integer,
                                  .standard = "2",
                                  .meaning = "Further tries of reads and of settings; a command is sent once.",
                                  .min = 0,
                                  .max = 10},
                              Key{.name = "short_answers",
                                  .kind = KeyKind::boolean,
                                  .standard = "false",
                                  .meaning = "Answers of fewer than 8 bytes are good if they hold what they need."},
                              Key{.name = "upload_style_write_answer",
                                  .kind = KeyKind::boolean,
                                  .standard = "false",
                                  .meaning = "A write may be confirmed in the form of an answer to a read."}};

constexpr std::array kEmcyKeys{Key{.name = "layout",
                                   .kind = KeyKind::choice,
                                   .standard = "cia301",
                                   .meaning = "How the emergency frame is filled.",
                                   .choices = "cia301|drive-code|class-and-vendor40"},
                               Key{.name = "reset_counts_remaining",
                                   .kind = KeyKind::boolean,
                                   .standard = "false",
                                   .meaning = "Byte 3 of an error reset counts the errors that remain."},
                               Key{.name = "drive_code_under",
                                   .kind = KeyKind::integer,
                                   .standard = "0: none",
                                   .meaning = "Emergency code under which the drive sends its own fault code.",
                                   .min = 0,
                                   .max = 0xFFFF},
                               Key{.name = "error_register",
                                   .kind = KeyKind::boolean,
                                   .standard = "true",
                                   .meaning = "0x1001 is read after a boot."},
                               Key{.name = "error_field",
                                   .kind = KeyKind::boolean,
                                   .standard = "true",
                                   .meaning = "0x1003 is read for the names of active errors."}};

constexpr Key identity(std::string_view name, std::string_view meaning) {
  return {.name = name, .kind = KeyKind::integer, .standard = "not compared", .meaning = meaning, .max = kMaxU32};
}
constexpr std::array kIdentityKeys{identity("device_type", "0x1000"), identity("vendor", "0x1018:01"),
                                   identity("product", "0x1018:02"), identity("revision", "0x1018:03"),
                                   identity("serial", "0x1018:04")};

constexpr std::array kSetupKeys{
    Key{.name = "object", .kind = KeyKind::object, .meaning = "What to write.", .required = true},
    Key{.name = "type", .kind = KeyKind::type, .meaning = "Its type; no reals.", .required = true},
    Key{.name = "value",
        .kind = KeyKind::integer,
        .meaning = "The raw value.",
        .min = kMinInteger,
        .max = kMaxInteger,
        .required = true}};

constexpr Section kPdo{.title = "tpdoN, rpdoN", .keys = kPdoKeys};
constexpr Section kErrorControl{.title = "error_control", .keys = kErrorControlKeys};
constexpr Section kSdo{.title = "sdo", .keys = kSdoKeys};
constexpr Section kEmcy{.title = "emcy", .keys = kEmcyKeys};
constexpr Section kIdentity{.title = "identity", .keys = kIdentityKeys};
constexpr Section kSetup{.title = "setup", .keys = kSetupKeys};

constexpr std::array kOverlayKeys{
    Key{.name = "signals", .kind = KeyKind::signals, .meaning = "By name.", .section = &kSignalSection},
    Key{.name = "tpdoN", .kind = KeyKind::table, .meaning = "What the drive sends.", .section = &kPdo},
    Key{.name = "rpdoN", .kind = KeyKind::table, .meaning = "What it receives.", .section = &kPdo},
    Key{.name = "inhibit_unit",
        .kind = KeyKind::choice,
        .standard = "100us",
        .meaning = "What the drive counts inhibit times in; CiA 301 has 100 us.",
        .choices = "100us|1ms"},
    Key{.name = "error_control", .kind = KeyKind::table, .meaning = "Heartbeat.", .section = &kErrorControl},
    Key{.name = "sdo", .kind = KeyKind::table, .meaning = "SDO transfer.", .section = &kSdo},
    Key{.name = "emcy", .kind = KeyKind::table, .meaning = "Emergency messages.", .section = &kEmcy},
    Key{.name = "identity", .kind = KeyKind::table, .meaning = "What must stand there.", .section = &kIdentity},
    Key{.name = "setup",
        .kind = KeyKind::tables,
        .meaning = "Further objects to write at every boot, in this order, after the profile's.",
        .section = &kSetup},
    Key{.name = "fault_texts",
        .kind = KeyKind::faults,
        .meaning = "Text by the drive's own fault code.",
        .min = 0,
        .max = kMaxInteger},
    Key{.name = "emcy_texts",
        .kind = KeyKind::faults,
        .meaning = "Text by emergency code; a code without one takes that of its class (0x2100, 0x2000).",
        .min = 0,
        .max = 0xFFFF}};

constexpr std::array kPresetKeys{
    Key{.name = "text", .kind = KeyKind::text, .meaning = "What it is for.", .required = true},
    Key{.name = "unconfirmed",
        .kind = KeyKind::text,
        .meaning = "Why it is not established; `check` warns where it is used."}};
constexpr Section kPreset{.title = "presets.NAME", .keys = kPresetKeys, .also = &kOverlaySection};

constexpr std::array kSlotKeys{
    Key{.name = "objects",
        .kind = KeyKind::texts,
        .meaning = "The freely assigned objects, from number 1.",
        .required = true},
    Key{.name = "standard",
        .kind = KeyKind::numbered,
        .meaning = "What they mean where the site states nothing.",
        .min = 1,
        .max = 64},
    Key{.name = "unconfirmed", .kind = KeyKind::text, .meaning = "Why `check` warns until the site states them."},
    Key{.name = "meanings",
        .kind = KeyKind::signals,
        .meaning = "The signals to choose from, without `object`.",
        .section = &kSignalSection,
        .required = true}};
constexpr Section kSlot{.title = "slots.settings, slots.returns", .keys = kSlotKeys};
constexpr std::array kSlotsKeys{
    Key{.name = "settings", .kind = KeyKind::table, .meaning = "Behind `settings` of a drive.", .section = &kSlot},
    Key{.name = "returns", .kind = KeyKind::table, .meaning = "Behind `returns` of a drive.", .section = &kSlot}};
constexpr Section kSlots{.title = "slots", .keys = kSlotsKeys};

constexpr std::array kProfileKeys{
    Key{.name = "title", .kind = KeyKind::text, .meaning = "What drive this is.", .required = true},
    Key{.name = "extends", .kind = KeyKind::name, .meaning = "A profile that this one is laid over."},
    Key{.name = "partial",
        .kind = KeyKind::boolean,
        .standard = "false",
        .meaning = "`true`: only to be extended, no drive by itself."},
    Key{.name = "presets",
        .kind = KeyKind::presets,
        .meaning = "What a drive can switch on by name.",
        .section = &kPreset},
    Key{.name = "slots", .kind = KeyKind::table, .meaning = "Freely assigned objects.", .section = &kSlots}};

}  // namespace

constinit const Section kOverlaySection{.title = "In a profile, a preset and a drive", .keys = kOverlayKeys};
constinit const Section kProfileSection{.title = "A profile", .keys = kProfileKeys, .also = &kOverlaySection};

}  // namespace config
