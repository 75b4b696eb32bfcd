#include <array>
#include <chrono>
#include <limits>

#include "canopen/clock.h"
#include "config/schema.h"

namespace config {
namespace {

constexpr std::int64_t kMs = canopen::Duration(std::chrono::milliseconds(1)).count();
constexpr std::int64_t kMaxInteger = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMinInteger = std::numeric_limits<std::int64_t>::min();

constexpr std::array kSignalKeys{
    Key{.name = "enabled",
        .kind = KeyKind::boolean,
        .standard = "true",
        .meaning = "`false`: the drive has no such signal."},
    Key{.name = "object", .kind = KeyKind::object, .meaning = "`\"0x2021:02\"`. Needed unless `from` is given."},
    Key{.name = "type",
        .kind = KeyKind::type,
        .meaning = "`bool`, `u8`, `u16`, `u32`, `u64`, `i8`, `i16`, `i32`, `i64`, `f32`, `f64`. Needed with `object`."},
    Key{.name = "from",
        .kind = KeyKind::text,
        .meaning = "Makes it a boolean read out of this other signal's raw word, by `mask` and `equals` or by "
                   "`negative`."},
    Key{.name = "mask", .kind = KeyKind::integer, .meaning = "Bits of the word.", .min = 1, .max = kMaxInteger},
    Key{.name = "equals",
        .kind = KeyKind::integers,
        .standard = "the mask itself",
        .meaning = "True where the masked word is one of these.",
        .min = 0,
        .max = kMaxInteger},
    Key{.name = "negative",
        .kind = KeyKind::boolean,
        .standard = "false",
        .meaning = "True where the word as a number is below zero."},
    Key{.name = "scale", .kind = KeyKind::number, .standard = "1", .meaning = "Engineering value = raw value x scale."},
    Key{.name = "unit", .kind = KeyKind::text, .meaning = "`\"Hz\"`."},
    Key{.name = "access",
        .kind = KeyKind::choice,
        .standard = "read",
        .meaning = "A value that goes out in an RPDO is `write`.",
        .choices = "read|write|read-write"},
    Key{.name = "source",
        .kind = KeyKind::text,
        .standard = "the PDO that maps it, else `sdo`",
        .meaning = "`\"tpdo1\"`, `\"rpdo1\"`, `\"sdo\"`."},
    Key{.name = "min", .kind = KeyKind::number, .standard = "none", .meaning = "Least value that may be commanded."},
    Key{.name = "max", .kind = KeyKind::number, .standard = "none", .meaning = "Greatest value that may be commanded."},
    Key{.name = "values",
        .kind = KeyKind::numbered,
        .standard = "none",
        .meaning = "Names of raw numbers: `{ 0 = \"stop\", 1 = \"run\" }`. Replaces the profile's as a whole.",
        .min = kMinInteger,
        .max = kMaxInteger},
    Key{.name = "momentary",
        .kind = KeyKind::integers,
        .standard = "[]",
        .meaning = "Raw values that are forgotten once sent: fault reset, jog.",
        .min = kMinInteger,
        .max = kMaxInteger},
    Key{.name = "momentary_mask",
        .kind = KeyKind::integer,
        .standard = "0",
        .meaning = "So is a value with one of these bits.",
        .min = 0,
        .max = kMaxInteger},
    Key{.name = "address",
        .kind = KeyKind::integer,
        .standard = "by name, see below",
        .meaning = "Modbus address, of a bit for booleans.",
        .min = 0,
        .max = 65535},
    Key{.name = "as",
        .kind = KeyKind::choice,
        .standard = "raw",
        .meaning = "`float`: two registers with the engineering value.",
        .choices = "raw|float"},
    Key{.name = "poll",
        .kind = KeyKind::duration,
        .standard = "1s",
        .meaning = "How often it is read by SDO.",
        .min = 10 * kMs,
        .max = 3'600'000 * kMs},
    Key{.name = "deadband",
        .kind = KeyKind::number,
        .standard = "0",
        .meaning = "MQTT: smaller changes are not published. Engineering units."},
    Key{.name = "publish_mask",
        .kind = KeyKind::integer,
        .standard = "all bits",
        .meaning = "MQTT: bits whose change alone causes a publish.",
        .min = 0,
        .max = kMaxInteger},
    Key{.name = "unconfirmed",
        .kind = KeyKind::boolean,
        .standard = "false",
        .meaning = "Meaning or scale is not established."}};

}  // namespace

constinit const Section kSignalSection{.title = "signals.NAME", .keys = kSignalKeys};

}  // namespace config
