#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/bus/echo.h"
#include "canopen/node/node_settings.h"
#include "canopen/object.h"

// What a site configured, checked and resolved against its profiles: plain immutable values, compared by value.

namespace config {

using canopen::Duration;

struct Gateway {
  std::string name;                                      ///< [A-Za-z0-9_-]{1,32}
  std::string state_dir = "/var/lib/canopen-gateway";    ///< Absolute. Alarms, journal, records. Empty: none.
  std::string control = "/run/canopen-gateway/control";  ///< Absolute, at most 107 bytes; empty: no control socket.
  std::uint64_t journal = 50'000'000;                    ///< Bytes that the journal of commands may take.
  friend bool operator==(const Gateway&, const Gateway&) = default;
};

struct Bus {
  std::string name;
  std::string interface;                 ///< A SocketCAN interface, or kVirtualInterface.
  std::optional<std::uint32_t> bitrate;  ///< bit/s
  std::uint8_t node_id = 127;            ///< 0: none
  Duration heartbeat = std::chrono::milliseconds(500);
  Duration sync{};        ///< Zero: none.
  double sdo_load = 0.7;  ///< 0.1..1: load that all traffic together may reach while SDO transfers run.
  canopen::EchoProves echo = canopen::EchoProves::by_driver;
  bool other_master = false;  ///< NMT, SYNC, SDO requests and RPDOs of somebody else are wanted.
  friend bool operator==(const Bus&, const Bus&) = default;
};
inline constexpr std::string_view kVirtualInterface = "virtual";

enum class Access : std::uint8_t { read, write, read_write };
[[nodiscard]] constexpr bool readable(Access access) noexcept {
  return access != Access::write;
}
[[nodiscard]] constexpr bool writable(Access access) noexcept {
  return access != Access::read;
}

/// Where a signal's value comes from, and for writable ones which way a value goes first.
enum class SourceKind : std::uint8_t { tpdo, rpdo, sdo };
struct Source {
  SourceKind kind = SourceKind::sdo;
  std::uint16_t number = 0;  ///< Of the PDO; 0 for SDO.
  friend bool operator==(const Source&, const Source&) = default;
};

/// A boolean read out of another signal's raw word: true where (word & mask) is one of `values`, or, with `negative`,
/// where the word as a signed number is below zero.
struct Derived {
  std::size_t from = 0;  ///< Position of the word in Drive::signals; always before this signal.
  std::uint64_t mask = 0;
  std::vector<std::uint64_t> values;
  bool negative = false;
  friend bool operator==(const Derived&, const Derived&) = default;
};

enum class ModbusKind : std::uint8_t { none, holding, bit };
struct ModbusPlace {
  ModbusKind kind = ModbusKind::none;
  std::uint16_t address = 0;  ///< PDU address, from 0.
  std::uint16_t count = 1;    ///< Registers: 1, 2 or 4.
  bool as_float = false;      ///< Engineering units as IEEE 754 single in two registers.
  friend bool operator==(const ModbusPlace&, const ModbusPlace&) = default;
};

struct Signal {
  std::string name;  ///< [a-z][a-z0-9_]*
  canopen::ObjectAddress object;
  canopen::DataType type = canopen::DataType::u16;
  double scale = 1.0;     ///< Engineering value = raw · scale.
  unsigned decimals = 0;  ///< Of the engineering value as text, from the scale: 0.01 gives 2.
  std::string unit;       ///< "Hz", "A"; may be empty.
  Access access = Access::read;
  Source source;
  std::optional<Derived> derived;
  std::optional<double> min;  ///< Engineering units.
  std::optional<double> max;
  std::map<std::int64_t, std::string> values;  ///< Enumeration of raw numbers; empty: none.
  std::vector<std::uint64_t> momentary;        ///< Raw values that are forgotten once sent (fault reset, jog).
  std::uint64_t momentary_mask = 0;            ///< So is a value with one of these bits (CiA 402: fault reset, bit 7).
  std::vector<std::uint64_t> edge;             ///< Momentary raw values that act by their rising edge alone.
  ModbusPlace modbus;
  Duration poll = std::chrono::seconds(1);         ///< Of a readable SDO signal.
  double deadband = 0.0;                           ///< MQTT: a smaller change causes no publish. Engineering units.
  std::uint64_t publish_mask = ~std::uint64_t{0};  ///< MQTT: bits of a word whose change alone causes a publish.
  bool unconfirmed = false;                        ///< The profile marks meaning or scale as not established.
  bool pdo_only = false;                           ///< The drive takes it in its RPDO alone; then `source` is one.
  friend bool operator==(const Signal&, const Signal&) = default;
};

/// `read`, `write`, `read-write`.
[[nodiscard]] std::string_view to_text(Access access) noexcept;
/// `tpdo1`, `rpdo1`, `sdo`.
[[nodiscard]] std::string to_text(const Source& source);

/// A value that is forgotten once sent: no later RPDO repeats it.
[[nodiscard]] bool is_momentary(const Signal& signal, canopen::Raw raw) noexcept;

enum class Severity : std::uint8_t { warning, fault };

/// Text of a fault code. Which code: of the drive where the EMCY layout carries one, else the EMCY's own.
struct FaultText {
  std::string text;
  Severity severity = Severity::fault;
  friend bool operator==(const FaultText&, const FaultText&) = default;
};

/// What decides and names a drive's errors.
struct FaultRules {
  std::map<std::uint64_t, FaultText> drive_texts;  ///< By the drive's own code.
  std::map<std::uint16_t, FaultText> emcy_texts;   ///< By the EMCY code (CiA 301, CiA 402); see find_emcy_text.
  std::optional<std::size_t> fault;                ///< Position in signals of the boolean that tells a fault.
  std::optional<std::size_t> warning;              ///< Likewise a warning.
  std::optional<std::size_t> fault_code;           ///< The word that names the newest fault.
  std::optional<std::size_t> running;              ///< The boolean that tells a turning motor.
  std::optional<std::size_t> quick_stop;           ///< The boolean that tells a quick stop: it may brake or stand.
  bool has_error_register = true;                  ///< False: 0x1001 is never read, as if the drive had none.
  bool error_register_follows = true;              ///< False: what 0x1001 holds decides nothing about the faults.
  bool has_error_field = true;                     ///< 0x1003 likewise, for names only.
  friend bool operator==(const FaultRules&, const FaultRules&) = default;
};

/// Text of an EMCY code: of the code itself, else of its class (0x2123: 0x2100, then 0x2000; CiA 301 table 26); null
/// where the profile has none.
[[nodiscard]] const FaultText* find_emcy_text(const FaultRules& rules, std::uint16_t code) noexcept;

enum class OnStale : std::uint8_t { exception, hold, zero };
enum class WordOrder : std::uint8_t { big, little };

struct Writers {
  bool modbus = false;
  bool mqtt = false;
  bool local = false;  ///< The control socket, which the command line uses.
  friend bool operator==(const Writers&, const Writers&) = default;

  [[nodiscard]] bool any() const noexcept { return modbus || mqtt || local; }
};

/// What the gateway does where the writer of the last control command gave no sign of life for `timeout`.
enum class OnTimeout : std::uint8_t {
  hold,   ///< Nothing but the alarm.
  cease,  ///< RPDOs are not repeated any more; the drive, which supervises one, trips.
  values  ///< Commands::timeout_values are written.
};

/// One of the values that a timeout writes: checked, and to be sent as it is.
struct TimeoutValue {
  std::size_t signal = 0;  ///< Position in Drive::signals; writable.
  canopen::Raw raw = 0;    ///< Within the limits of the signal; no momentary value.
  friend bool operator==(const TimeoutValue&, const TimeoutValue&) = default;
};

struct Commands {
  Writers writers;
  bool raw = false;
  bool nmt_while_running = false;
  Duration deadline = std::chrono::milliseconds(800);
  Duration lease{};    ///< 0..24 h; zero: no writer keeps the drive to himself.
  Duration timeout{};  ///< 0..24 h; zero: silence of the writer does nothing.
  OnTimeout on_timeout = OnTimeout::hold;
  /// In the order of the file, `control_command` (then a stop) first. Never empty with OnTimeout::values.
  std::vector<TimeoutValue> timeout_values{};
  Duration feedback{};  ///< 0..1 h; >0: `running` and a stop of `control_command` are known.
  friend bool operator==(const Commands&, const Commands&) = default;
};

struct Drive {
  std::string name;
  bool enabled = true;  ///< False: out of service. No traffic, no alarms; unit and addresses stay.
  std::size_t bus = 0;  ///< Position in Model::buses.
  std::string profile;
  std::optional<std::uint8_t> unit;   ///< Modbus unit 1..247; nothing: it has none of its own.
  std::optional<std::uint16_t> flat;  ///< Base of its block on Modbus::flat_unit; nothing: it is not there.
  canopen::NodeSettings node;         ///< node.node is the node id.
  std::vector<Signal> signals;        ///< Words before the booleans derived from them.
  FaultRules faults;
  Commands commands;
  OnStale on_stale = OnStale::exception;
  friend bool operator==(const Drive&, const Drive&) = default;

  [[nodiscard]] std::optional<std::size_t> find(std::string_view signal_name) const noexcept;
};

struct Endpoint {
  std::string host;  ///< Numeric address or name, IPv6 without brackets.
  std::uint16_t port = 0;
  bool tls = false;  ///< Of a broker: `mqtts://`.
  friend bool operator==(const Endpoint&, const Endpoint&) = default;
};

/// An address range such as 127.0.0.0/8 or ::1/128.
struct Network {
  std::string address;  ///< Numeric.
  unsigned prefix = 0;
  friend bool operator==(const Network&, const Network&) = default;
};

struct Modbus {
  std::vector<Endpoint> listen{{"0.0.0.0", 502}};
  std::size_t max_clients = 32;
  Duration idle_timeout = std::chrono::minutes(10);
  std::vector<Network> read_from{{"0.0.0.0", 0}, {"::", 0}};
  std::vector<Network> write_from{{"127.0.0.0", 8}, {"::1", 128}};
  WordOrder word_order = WordOrder::big;
  OnStale on_stale = OnStale::exception;  ///< What drives have that say nothing else.
  std::optional<std::uint8_t> flat_unit;  ///< 1..247: shows all drives that have a base; nothing: there is none.
  friend bool operator==(const Modbus&, const Modbus&) = default;
};

/// Of the protocol.
enum class MqttVersion : std::uint8_t { automatic, v5, v3_1_1 };

/// How long live topics outlive the gateway where the file does not say so.
[[nodiscard]] constexpr Duration default_expiry(Duration max_interval) noexcept {
  return std::max<Duration>(std::chrono::seconds(90), 3 * max_interval);
}

struct Mqtt {
  std::vector<Endpoint> brokers{{"127.0.0.1", 1883}};  ///< In the order in which they are tried.
  MqttVersion version = MqttVersion::automatic;
  std::string client_id;  ///< Empty: `canopen-gateway-` and the gateway's name.
  std::string base = "canopen";
  std::string username;
  std::string password_file;  ///< Path, as the following; empty: none. Its first line, read at each connection.
  std::string ca_file;        ///< Authorities that brokers with TLS are trusted by; empty: those of the system.
  std::string cert_file;      ///< Of the client, with key_file; empty: none.
  std::string key_file;
  int qos = 1;  ///< 0 or 1 (2 is refused)
  bool state = true;
  bool signals = true;
  Duration min_interval = std::chrono::milliseconds(250);
  Duration max_interval = std::chrono::seconds(60);
  Duration expiry = default_expiry(max_interval);   ///< MQTT 5: of live topics; 0: they stand for ever.
  std::optional<std::vector<std::string>> answers;  ///< Filters of response topics; nothing: any outside of `base`.
  std::string stale_payload;                        ///< Of a plain topic while its value is not fresh.
  std::string home_assistant;                       ///< Prefix of its discovery topics; empty: off. Needs `state`.
  friend bool operator==(const Mqtt&, const Mqtt&) = default;
};

/// The HTTP server, which only shows.
struct Http {
  Endpoint listen{"127.0.0.1", 9464};
  std::vector<Network> read_from{{"127.0.0.0", 8}, {"::1", 128}};
  std::vector<std::string> hosts;  ///< Further names, in lower case, that a request may have for its host.
  friend bool operator==(const Http&, const Http&) = default;
};

/// Records of the frames around a fault. Needs a state directory.
struct Recorder {
  Duration before = std::chrono::seconds(10);
  Duration after = std::chrono::seconds(5);
  std::uint64_t keep = 200'000'000;  ///< Bytes that all records together may take.
  friend bool operator==(const Recorder&, const Recorder&) = default;
};

struct Model {
  Gateway gateway;
  std::vector<Bus> buses;
  std::vector<Drive> drives;
  std::optional<Modbus> modbus;
  std::optional<Mqtt> mqtt;
  std::optional<Http> http;
  std::optional<Recorder> recorder;
  friend bool operator==(const Model&, const Model&) = default;
};

/// Of each bus or drive of a newer model the position of the very same in an older one; nothing: it is new, or another.
using Positions = std::vector<std::optional<std::size_t>>;

/// The position of the one with this name.
template <class Named>
[[nodiscard]] std::optional<std::size_t> find_named(const std::vector<Named>& all, const std::string& name) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name == name) {
      return i;
    }
  }
  return std::nullopt;
}

}  // namespace config
