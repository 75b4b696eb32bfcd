#include <array>
#include <chrono>

#include "canopen/clock.h"
#include "config/schema.h"
#include "config/schema_limits.h"

namespace config {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t ns(canopen::Duration duration) {
  return duration.count();
}
constexpr std::int64_t kDay = ns(std::chrono::hours(24));

constexpr std::array kGatewayKeys{Key{
    .name = "name", .kind = KeyKind::name, .standard = "the host's name", .meaning = "Second part of every topic."}};
constexpr Section kGateway{.title = "[gateway]", .keys = kGatewayKeys};

constexpr std::array kBusKeys{
    Key{.name = "name", .kind = KeyKind::name, .meaning = "Names the bus in topics and drives.", .required = true},
    Key{.name = "interface",
        .kind = KeyKind::text,
        .standard = "the bus' name",
        .meaning = "A SocketCAN interface, or `virtual`: a bus inside the process."},
    Key{.name = "bitrate",
        .kind = KeyKind::integer,
        .standard = "none: no load shown",
        .meaning = "Bit/s, only to work out the bus load; the system sets the interface up.",
        .min = 10'000,
        .max = 1'000'000},
    Key{.name = "node_id",
        .kind = KeyKind::integer,
        .standard = "127",
        .meaning = "The gateway's own node id; 0: none, and no heartbeat.",
        .min = 0,
        .max = 127},
    Key{.name = "heartbeat",
        .kind = KeyKind::duration,
        .standard = "500ms",
        .meaning = "Period of the gateway's own heartbeat; `0s`: none.",
        .min = 0,
        .max = kMs16},
    Key{.name = "sync",
        .kind = KeyKind::duration,
        .standard = "none: no SYNC",
        .meaning = "Period of the SYNC that the gateway sends; `0s`: none.",
        .min = 0,
        .max = 60'000 * kMs}};
constexpr Section kBus{.title = "[[bus]]", .keys = kBusKeys};

constexpr std::array kModbusKeys{
    Key{.name = "listen",
        .kind = KeyKind::texts,
        .standard = "[\"0.0.0.0:502\"]",
        .meaning = "Addresses to listen on, `\"[::]:502\"` for IPv6."},
    Key{.name = "max_clients",
        .kind = KeyKind::integer,
        .standard = "32",
        .meaning = "Connections at a time.",
        .min = 1,
        .max = 1000},
    Key{.name = "idle_timeout",
        .kind = KeyKind::duration,
        .standard = "10min",
        .meaning = "A client silent for this long is disconnected; `0s`: never.",
        .min = 0,
        .max = kDay},
    Key{.name = "read_from",
        .kind = KeyKind::texts,
        .standard = "[\"0.0.0.0/0\", \"::/0\"]",
        .meaning = "Networks whose clients may connect and read."},
    Key{.name = "write_from",
        .kind = KeyKind::texts,
        .standard = "[\"127.0.0.0/8\", \"::1/128\"]",
        .meaning = "Networks whose clients may write."},
    Key{.name = "word_order",
        .kind = KeyKind::choice,
        .standard = "big",
        .meaning = "Of values of more than one register: `big` puts the high word first.",
        .choices = "big|little"},
    Key{.name = "on_stale",
        .kind = KeyKind::choice,
        .standard = "exception",
        .meaning = "Reading a value that is not fresh: exception 0x0B, its last value, or 0.",
        .choices = "exception|hold|zero"}};
constexpr Section kModbus{.title = "[modbus]", .keys = kModbusKeys};

constexpr std::array kMqttKeys{
    Key{.name = "brokers",
        .kind = KeyKind::texts,
        .standard = "[\"mqtt://127.0.0.1:1883\"]",
        .meaning = "One broker in this version; `mqtts://` is for a later one."},
    Key{.name = "base", .kind = KeyKind::text, .standard = "canopen", .meaning = "First part of every topic."},
    Key{.name = "qos",
        .kind = KeyKind::integer,
        .standard = "1",
        .meaning = "Quality of service of what is published.",
        .min = 0,
        .max = 1},
    Key{.name = "state", .kind = KeyKind::boolean, .standard = "true", .meaning = "One JSON topic per drive."},
    Key{.name = "signals", .kind = KeyKind::boolean, .standard = "true", .meaning = "One plain topic per signal."},
    Key{.name = "min_interval",
        .kind = KeyKind::duration,
        .standard = "250ms",
        .meaning = "A value is published not more often than this; `0s`: at every change.",
        .min = 0,
        .max = kDay},
    Key{.name = "max_interval",
        .kind = KeyKind::duration,
        .standard = "60s",
        .meaning = "A value is published at least this often.",
        .min = 1000 * kMs,
        .max = kDay},
    Key{.name = "username", .kind = KeyKind::text, .meaning = "For the broker."},
    Key{.name = "password_file",
        .kind = KeyKind::text,
        .meaning = "File with the password in its first line, read at the start; needs `username`."},
    Key{.name = "ca_file", .kind = KeyKind::text, .meaning = "For TLS.", .support = Support::none},
    Key{.name = "cert_file", .kind = KeyKind::text, .meaning = "For TLS.", .support = Support::none},
    Key{.name = "key_file", .kind = KeyKind::text, .meaning = "For TLS.", .support = Support::none},
    Key{.name = "home_assistant", .kind = KeyKind::text, .meaning = "Discovery topics.", .support = Support::none}};
constexpr Section kMqtt{.title = "[mqtt]", .keys = kMqttKeys};

constexpr std::array kCommandsKeys{
    Key{.name = "writers",
        .kind = KeyKind::choices,
        .standard = "[]: nobody",
        .meaning = "Who may command: `modbus`, `mqtt`, `local` (the command line, which cannot command in this version)"
                   ". Nobody else may write, send NMT commands or write raw objects.",
        .choices = "modbus|mqtt|local"},
    Key{.name = "raw",
        .kind = KeyKind::boolean,
        .standard = "false",
        .meaning = "`true`: writers may write objects that are no writable signal."},
    Key{.name = "nmt_while_running",
        .kind = KeyKind::boolean,
        .standard = "false",
        .meaning = "`true`: NMT stop, pre-operational and resets also while the motor runs."},
    Key{.name = "deadline",
        .kind = KeyKind::duration,
        .standard = "800ms",
        .meaning = "Of one command, answer included.",
        .min = 10 * kMs,
        .max = 60'000 * kMs},
    Key{.name = "lease",
        .kind = KeyKind::duration,
        .standard = "0s",
        .meaning = "A writer keeps the drive to itself until silent for this long.",
        .min = 0,
        .max = kDay,
        .support = Support::default_only},
    Key{.name = "timeout",
        .kind = KeyKind::duration,
        .standard = "0s",
        .meaning = "Silence of the writer after which `on_timeout` acts.",
        .min = 0,
        .max = kDay,
        .support = Support::default_only},
    Key{.name = "on_timeout",
        .kind = KeyKind::choice,
        .standard = "hold",
        .meaning = "What a timeout does.",
        .choices = "hold|cease|values",
        .support = Support::default_only},
    Key{.name = "values",
        .kind = KeyKind::table,
        .meaning = "What `on_timeout = \"values\"` writes.",
        .support = Support::none}};
constexpr Section kCommands{.title = "[drive.commands]", .keys = kCommandsKeys};

constexpr std::array kDriveKeys{
    Key{.name = "name", .kind = KeyKind::name, .meaning = "Names the drive in topics and findings.", .required = true},
    Key{.name = "bus",
        .kind = KeyKind::text,
        .standard = "the only bus",
        .meaning = "Name of its bus; needed where there are several."},
    Key{.name = "node", .kind = KeyKind::integer, .meaning = "Node id.", .min = 1, .max = 127, .required = true},
    Key{.name = "profile", .kind = KeyKind::name, .meaning = "What kind of drive it is.", .required = true},
    Key{.name = "eds", .kind = KeyKind::text, .meaning = "A drive from an EDS file.", .support = Support::none},
    Key{.name = "unit",
        .kind = KeyKind::unit,
        .standard = "the node id",
        .meaning = "Modbus unit; `\"none\"`: not on Modbus.",
        .min = 1,
        .max = 247},
    Key{.name = "heartbeat",
        .kind = KeyKind::duration,
        .standard = "500ms",
        .meaning = "Heartbeat period written to the drive (0x1017), whole milliseconds.",
        .min = kMs,
        .max = kMs16},
    Key{.name = "heartbeat_timeout",
        .kind = KeyKind::duration,
        .standard = "1500ms",
        .meaning = "Silence that means the drive is lost; longer than `heartbeat`.",
        .min = 2 * kMs,
        .max = 600'000 * kMs},
    Key{.name = "supervise_gateway",
        .kind = KeyKind::duration,
        .standard = "0s",
        .meaning = "The drive trips when the gateway's heartbeat is missing this long (0x1016); `0s`: it does not.",
        .min = 0,
        .max = kMs16},
    Key{.name = "on_stale",
        .kind = KeyKind::choice,
        .standard = "as in [modbus]",
        .meaning = "The same for this drive alone.",
        .choices = "exception|hold|zero"},
    Key{.name = "reconfigure_running",
        .kind = KeyKind::boolean,
        .standard = "false",
        .meaning = "`true`: a drive found operational with other settings is configured all the same."},
    Key{.name = "presets", .kind = KeyKind::texts, .standard = "[]", .meaning = "Parts of the profile to switch on."},
    Key{.name = "settings",
        .kind = KeyKind::numbered,
        .standard = "the profile's",
        .meaning =
            "What the freely assigned set-points of the drive mean: `{ 1 = \"frequency_command\" }`; `\"unused\"` "
            "sends 0.",
        .min = 1,
        .max = 64},
    Key{.name = "returns",
        .kind = KeyKind::numbered,
        .standard = "the profile's",
        .meaning = "What the freely assigned returned values of the drive mean.",
        .min = 1,
        .max = 64},
    Key{.name = "commands", .kind = KeyKind::table, .meaning = "Who may command it.", .section = &kCommands}};

constexpr std::array kRootKeys{
    Key{.name = "gateway", .kind = KeyKind::table, .meaning = "The gateway itself.", .section = &kGateway},
    Key{.name = "bus", .kind = KeyKind::tables, .meaning = "The CAN buses.", .section = &kBus, .required = true},
    Key{.name = "modbus",
        .kind = KeyKind::table,
        .standard = "off",
        .meaning = "The Modbus TCP server.",
        .section = &kModbus},
    Key{.name = "mqtt", .kind = KeyKind::table, .standard = "off", .meaning = "The MQTT client.", .section = &kMqtt},
    Key{.name = "http", .kind = KeyKind::table, .standard = "off", .meaning = "Metrics.", .support = Support::none},
    Key{.name = "drive",
        .kind = KeyKind::tables,
        .meaning = "The drives.",
        .section = &kDriveSection,
        .required = true}};

}  // namespace

constinit const Section kDriveSection{.title = "[[drive]]", .keys = kDriveKeys, .also = &kOverlaySection};
constinit const Section kSiteSection{.title = "The file", .keys = kRootKeys};

}  // namespace config
