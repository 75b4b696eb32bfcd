#include "config/site/site_keys.h"

#include <chrono>

#include "config/drive/drive_keys.h"
#include "config/site/endpoint.h"

namespace config {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr std::uint16_t kHttpPort = 9464;
constexpr hours kDay(24);
constexpr hours kWeek(7 * 24);

// sockaddr_un::sun_path has 108 bytes, the last of them 0.
constexpr std::size_t kLongestSocket = 107;

/// Each way of a record: what a full bus of 1 Mbit/s keeps in memory stays below 35 MB.
constexpr minutes kLongestRecorded(2);

/// What stands in a table that is only checked.
struct Nothing {};

}  // namespace

Form<OnStale> on_stale_form() {
  return choice<OnStale>({{"exception", OnStale::exception}, {"hold", OnStale::hold}, {"zero", OnStale::zero}});
}

const SectionOf<Gateway>& gateway_section() {
  using Field = KeyOf<Gateway>;
  static const SectionOf<Gateway> section(
      "[gateway]",
      {Field("name", &Gateway::name, name(), "Second part of every topic.").unset("the host's name"),
       Field("state_dir", &Gateway::state_dir, absolute_path({.may_be_empty = true}),
             "Directory of what outlives the process: alarms, the journal of commands, records; empty: nothing does."),
       Field("control", &Gateway::control,
             absolute_path(
                 {.longest = kLongestSocket, .why_no_longer = " in the address of a socket", .may_be_empty = true}),
             "The socket of the command line, at most 107 bytes; empty: none."),
       Field("journal", &Gateway::journal, size(1'000'000, 1'000'000'000'000),
             "What the journal of commands may take; its oldest files go first.")});
  return section;
}

const SectionOf<Bus>& bus_section() {
  using Field = KeyOf<Bus>;
  static const SectionOf<Bus> section(
      "[[bus]]",
      {Field("name", &Bus::name, name(), "Names the bus in topics and drives.").required(),
       Field("interface", &Bus::interface, text(), "A SocketCAN interface, or `virtual`: a bus inside the process.")
           .unset("the bus' name"),
       Field("bitrate", &Bus::bitrate, integer(10'000, 1'000'000, "bit/s", "250000"),
             "Bit/s, for load and waiting times; the system sets the interface up. Where the interface tells its own, "
             "that one is used.")
           .unset("by the interface; no load shown where it tells none"),
       Field("node_id", &Bus::node_id, integer(0, 127), "The gateway's own node id; 0: none, and no heartbeat."),
       Field("heartbeat", &Bus::heartbeat, duration({.min = seconds(0), .max = kLongest16, .whole_ms = true}),
             "Period of the gateway's own heartbeat; `0s`: none."),
       Field("sync", &Bus::sync, duration({.min = milliseconds(1), .max = minutes(1), .zero = true}),
             "Period of the SYNC that the gateway sends; `0s`: none.")
           .unset("none: no SYNC"),
       Field(
           "sdo_load", &Bus::sdo_load, number(0.1, 1.0),
           "Load that all traffic together may reach while SDO transfers of the gateway run; SDO keeps a tenth of the "
           "bus all the same. Without `bitrate`: eight transfers at once."),
       Field("other_master", &Bus::other_master, boolean(),
             "`true`: NMT, SYNC, SDO requests and RPDOs of somebody else are a remark, no alarm."),
       Field("echo", &Bus::echo,
             choice<canopen::EchoProves>({{"auto", canopen::EchoProves::by_driver},
                                          {"departure", canopen::EchoProves::departure},
                                          {"adapter", canopen::EchoProves::adapter}}),
             "What an own echo proves: that the frame left, or only that the adapter has it; `auto`: by the driver.")});
  return section;
}

const SectionOf<Modbus>& modbus_section() {
  using Field = KeyOf<Modbus>;
  static const SectionOf<Modbus> section(
      "[modbus]",
      {Field("listen", &Modbus::listen, list("list of strings", endpoint()),
             "Addresses to listen on, `\"[::]:502\"` for IPv6."),
       Field("max_clients", &Modbus::max_clients, integer(1, 1000), "Connections at a time."),
       Field("idle_timeout", &Modbus::idle_timeout, duration({.min = seconds(1), .max = kDay}),
             "A client silent for this long is disconnected."),
       Field("read_from", &Modbus::read_from, list("list of strings", network()),
             "Networks whose clients may connect and read."),
       Field("write_from", &Modbus::write_from, list("list of strings", network()),
             "Networks whose clients may write."),
       Field("word_order", &Modbus::word_order,
             choice<WordOrder>({{"big", WordOrder::big}, {"little", WordOrder::little}}),
             "Of values of more than one register: `big` puts the high word first."),
       Field("on_stale", &Modbus::on_stale, on_stale_form(),
             "Reading a value that is not fresh: exception 0x0B, its last value, or 0."),
       Field("flat_unit", &Modbus::flat_unit, integer(1, 247), "A unit that shows all drives that have a `flat` base.")
           .unset("none")});
  return section;
}

const SectionOf<Mqtt>& mqtt_section() {
  using Field = KeyOf<Mqtt>;
  static const SectionOf<Mqtt> section(
      "[mqtt]",
      {Field("brokers", &Mqtt::brokers, list("list of strings", broker()),
             "`mqtt://HOST:PORT`, or `mqtts://HOST:PORT` for TLS. Of several one is in use, the first that can be: see "
             "[MQTT.md](MQTT.md#several-brokers)."),
       Field("version", &Mqtt::version,
             choice<MqttVersion>(
                 {{"auto", MqttVersion::automatic}, {"5", MqttVersion::v5}, {"3.1.1", MqttVersion::v3_1_1}}),
             "Of the protocol; `auto`: 5, and 3.1.1 where the broker does not know that."),
       Field("client_id", &Mqtt::client_id, text(),
             "Whom the broker knows the gateway as; no other client may have the same.")
           .unset("canopen-gateway-NAME"),
       Field("base", &Mqtt::base, text(), "First part of every topic."),
       Field("qos", &Mqtt::qos, integer(0, 1),
             "Quality of service of what is published. 0: nobody acknowledges, see "
             "[MQTT.md](MQTT.md#what-is-true-without-the-gateway)."),
       Field("state", &Mqtt::state, boolean(), "One JSON topic per drive."),
       Field("signals", &Mqtt::signals, boolean(), "One plain topic per signal."),
       Field("min_interval", &Mqtt::min_interval, duration({.min = seconds(0), .max = kDay}),
             "A value is published not more often than this; `0s`: at every change."),
       Field("max_interval", &Mqtt::max_interval, duration({.min = seconds(1), .max = kDay}),
             "A value is published at least this often.")
           .unset("60s"),
       Field("expiry", &Mqtt::expiry, duration({.min = seconds(3), .max = kWeek, .zero = true}),
             "MQTT 5: how long live topics outlive the gateway at a broker; they are published again at a third of it. "
             "`0s`: for ever. At least three times `min_interval`.")
           .unset("90s, or three times `max_interval` where that is longer"),
       Field("answers", &Mqtt::answers, list("list of strings", text()),
             "Topic filters: where response topics may lie, always outside of `base`; `[]`: nowhere.")
           .unset("anywhere outside of `base`"),
       Field("stale_payload", &Mqtt::stale_payload, text(),
             "What a plain topic shows while its value is not fresh; a word that no value is."),
       Field("username", &Mqtt::username, filled_text(), "For the broker."),
       Field("password_file", &Mqtt::password_file, filled_text(),
             "File with the password in its first line; needs `username`. Read at each connection, as are the next."),
       Field("ca_file", &Mqtt::ca_file, filled_text(),
             "Certificates of the authorities that brokers with TLS are trusted by, in PEM.")
           .unset("those of the system"),
       Field("cert_file", &Mqtt::cert_file, filled_text(),
             "The gateway's own certificate for the broker, with its chain, in PEM; needs `key_file`."),
       Field("key_file", &Mqtt::key_file, filled_text(), "The private key of `cert_file`, in PEM, without a password."),
       Field("home_assistant", &Mqtt::home_assistant, text(),
             "The prefix of Home Assistant's discovery topics, there `homeassistant` by default: the drives show there "
             "by themselves. Needs `state`. See [MQTT.md](MQTT.md#home-assistant).")
           .unset("off")});
  return section;
}

const SectionOf<Http>& http_section() {
  using Field = KeyOf<Http>;
  static const SectionOf<Http> section(
      "[http]",
      {Field("listen", &Http::listen, endpoint(kHttpPort),
             "Address to listen on. What is shown there, nobody can change."),
       Field("read_from", &Http::read_from, list("list of strings", network()), "Networks whose clients may read."),
       Field("hosts", &Http::hosts, list("list of strings", host()),
             "Further names of this machine, as they stand in the address line of a browser. `localhost` and the "
             "machine's addresses are always answered.")});
  return section;
}

const SectionOf<Recorder>& recorder_section() {
  using Field = KeyOf<Recorder>;
  static const SectionOf<Recorder> section(
      "[recorder]",
      {Field("before", &Recorder::before, duration({.min = seconds(1), .max = kLongestRecorded}),
             "Frames of how long before a fault are recorded; they are held in memory all the time."),
       Field("after", &Recorder::after, duration({.min = seconds(0), .max = kLongestRecorded}),
             "And of how long after its begin."),
       Field("keep", &Recorder::keep, size(1'000'000, 1'000'000'000'000),
             "What all records together may take; the oldest go first, those of faults that came first last.")});
  return section;
}

const Section& site_section() {
  using Field = KeyOf<Nothing>;
  const auto table = [](std::string_view name, const Section& section, std::string_view meaning) {
    return Field::table(name, section, meaning).unset(name == "gateway" ? "" : "off");
  };
  const auto tables = [](std::string_view name, const Section& section, std::string_view meaning) {
    return Field::tables(name, section, meaning).filled().required();
  };
  static const SectionOf<Nothing> section(
      "The file",
      {table("gateway", gateway_section(), "The gateway itself."), tables("bus", bus_section(), "The CAN buses."),
       table("modbus", modbus_section(), "The Modbus TCP server."), table("mqtt", mqtt_section(), "The MQTT client."),
       table("http", http_section(), "The HTTP server: metrics, health, an API that only shows."),
       table("recorder", recorder_section(), "Records of the frames around a fault, see [RECORDER.md](RECORDER.md)."),
       tables("drive", drive_section(), "The drives.")});
  return section;
}

}  // namespace config
