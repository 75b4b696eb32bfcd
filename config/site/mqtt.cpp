#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "config/schema/complaint.h"
#include "config/site/endpoint.h"
#include "config/site/site.h"
#include "config/site/site_keys.h"
#include "config/text.h"
#include "config/toml/document.h"
#include "config/toml/files.h"

namespace config {
namespace {

/// Those of the list that could be read; one that could not is its own mistake.
void check_brokers(const Node& table, const Mqtt& mqtt, Report& report) {
  const Node* const list = table.find("brokers");
  if (list == nullptr || list->kind != NodeKind::list) {
    return;
  }
  if (list->items.empty()) {
    report.error(list->place, "mqtt.brokers is empty; leave [mqtt] out where no MQTT is wanted");
    return;
  }
  std::vector<Endpoint> seen;
  for (const Node& item : list->items) {
    const std::optional<Endpoint> broker = item.kind == NodeKind::text ? parse_broker(item.text) : std::nullopt;
    if (!broker) {
      continue;
    }
    const std::string label = "mqtt.brokers " + in_quotes(item.text);
    if (broker->tls && broker->host.find(':') != std::string::npos) {
      // Paho compares the certificate with the host in its brackets, which no certificate has.
      report.error(item.place,
                   label + ": mqtts:// needs a name or an IPv4 address; name the broker as its certificate does");
    }
    const bool again = std::ranges::any_of(
        seen, [&broker](const Endpoint& each) { return each.host == broker->host && each.port == broker->port; });
    if (again) {
      report.error(item.place, label + " is named twice; each broker is tried in its turn");
    } else if (!broker->tls && !mqtt.password_file.empty() &&
               std::ranges::any_of(mqtt.brokers, [](const Endpoint& each) { return each.tls; })) {
      report.warning(item.place, label +
                                     " is told the password in the clear, which TLS hides at the others; whoever "
                                     "keeps us from those can read it. Name it as mqtts://");
    }
    seen.push_back(*broker);
  }
}

bool is_topic(const std::string& text) {
  return !text.empty() && !text.starts_with('/') && !text.ends_with('/') && !text.starts_with('$') &&
         text.find_first_of("+#") == std::string::npos && text.find("//") == std::string::npos;
}

void check_base(const Node& table, const std::string& base, Report& report) {
  if (!is_topic(base)) {
    report.error(place_of(table, "base"),
                 "mqtt.base " + in_quotes(base) + " must be a topic without '+', '#', a leading '$', or an empty part");
  }
}

// Nothing here changes the environment.
const char* credentials_directory() {
  return std::getenv("CREDENTIALS_DIRECTORY");  // NOLINT(concurrency-mt-unsafe)
}

/// Where it is: a relative one among the credentials that systemd hands over, else beside the configuration.
std::filesystem::path path_of(const std::string& stated, const std::filesystem::path& directory) {
  if (const char* const credentials = credentials_directory()) {
    std::filesystem::path path = std::filesystem::path(credentials) / stated;
    if (!is_absent(path)) {
      return path;
    }
  }
  return directory / stated;
}

/// A key that names a file, and what else is told of it.
struct FileKey {
  const char* name;
  std::string Mqtt::* stated;
  bool secret;
  const char* holds;
};
// The group of the unit and so of the control socket.
constexpr const char* kOperators = "canopen-gateway";

constexpr FileKey kPassword{"password_file", &Mqtt::password_file, true, "its first line is the password"};
constexpr std::array<FileKey, 3> kTls{{{"ca_file", &Mqtt::ca_file, false, "it holds PEM certificates"},
                                       {"cert_file", &Mqtt::cert_file, false, "it holds a PEM certificate"},
                                       {"key_file", &Mqtt::key_file, true, "it holds the PEM key of cert_file"}}};

/// A relative file that is absent where systemd hands over no credentials, as in a shell: it may be one of the service.
bool may_be_credential(const Node& table, const FileKey& key, const std::filesystem::path& path) {
  const Node* const stated = table.find(key.name);
  return credentials_directory() == nullptr && stated != nullptr && std::filesystem::path(stated->text).is_relative() &&
         is_absent(path);
}

/// Only what can be told without a look into it. `with_secrets`: it is to be used now.
bool check_file(const Node& table, const FileKey& key, const std::string& label, const std::filesystem::path& path,
                bool with_secrets, Report& report) {
  const Place place = place_of(table, key.name);
  if (!with_secrets && may_be_credential(table, key, path)) {
    report.warning(place, label +
                              " is not beside the configuration; a credential of the service (LoadCredential=)? "
                              "Else put it there");
    return false;
  }
  const auto facts = look_at_file(path);
  if (const auto* const failure = std::get_if<FileFailure>(&facts); failure != nullptr) {
    report.error(place, label + " cannot be read: " + failure->reason);
    return false;
  }
  if (key.secret && std::get<FileFacts>(facts).readable_by_all) {
    report.warning(place, label + " can be read by everybody on this machine; chmod o-r it");
  } else if (key.secret && group_may_read(path, kOperators)) {
    report.warning(place, label + " can be read by everybody in the group " + kOperators +
                              ", which people join to ask and to command; let the user of that name own it, and chmod "
                              "600 it");
  }
  if (std::get<FileFacts>(facts).size == 0) {
    report.error(place, label + " is empty; " + key.holds);
    return false;
  }
  return true;
}

/// The path takes the place of what was stated; the secret itself is read when it is used.
void take_password(const Node& table, Mqtt& mqtt, const std::filesystem::path& directory, bool with_secrets,
                   Report& report) {
  const std::string label = "mqtt.password_file " + in_quotes(mqtt.password_file);
  mqtt.password_file = path_of(mqtt.password_file, directory).string();
  if (!check_file(table, kPassword, label, mqtt.password_file, with_secrets, report) || !with_secrets) {
    return;
  }
  const auto content = read_file(mqtt.password_file);
  const Place place = place_of(table, "password_file");
  if (const auto* const failure = std::get_if<FileFailure>(&content); failure != nullptr) {
    report.error(place, label + " cannot be read: " + failure->reason);
  } else if (std::get<std::string>(content).find_first_of("\r\n") == 0) {
    report.error(place, label + " begins with an empty line; its first line is the password");
  }
}

/// Each broker is one without TLS, by what is stated: one that could not be read is its own mistake.
bool speaks_plainly(const Node& table) {
  const Node* const list = table.find("brokers");
  return list == nullptr || (list->kind == NodeKind::list && std::ranges::all_of(list->items, [](const Node& each) {
                               return each.text.starts_with("mqtt://");
                             }));
}

void take_tls_files(const Node& table, Mqtt& mqtt, const std::filesystem::path& directory, bool with_secrets,
                    Report& report) {
  const bool plain = speaks_plainly(table);
  for (const FileKey& key : kTls) {
    std::string& stated = mqtt.*key.stated;
    if (stated.empty()) {
      continue;
    }
    const std::string name = std::string("mqtt.") + key.name;
    if (plain) {
      report.error(place_of(table, key.name),
                   name + " is of use only with TLS; name the broker as mqtts://HOST:PORT, or leave it out");
    }
    const std::string label = name + " " + in_quotes(stated);
    stated = path_of(stated, directory).string();
    (void)check_file(table, key, label, stated, with_secrets, report);
  }
  if (mqtt.cert_file.empty() != mqtt.key_file.empty()) {
    const bool cert = mqtt.key_file.empty();
    report.error(place_of(table, cert ? "cert_file" : "key_file"),
                 cert ? "mqtt.cert_file needs key_file" : "mqtt.key_file needs cert_file");
  }
}

/// A topic filter that MQTT knows: '+' is a whole part, '#' the last one (MQTT 5 §4.7.1).
bool is_filter(std::string_view filter) {
  while (!filter.empty()) {
    const std::size_t slash = filter.find('/');
    const std::string_view part = filter.substr(0, slash);
    if (part.size() > 1 && part.find_first_of("+#") != std::string_view::npos) {
      return false;
    }
    if (slash == std::string_view::npos) {
      return true;
    }
    if (part == "#") {
      return false;
    }
    filter.remove_prefix(slash + 1);
  }
  return true;  // nothing behind the last slash is an empty part
}

/// Filters that let answers go where they never may go, or nowhere, are mistakes.
void check_answers(const Node& table, const std::string& base, Report& report) {
  for (const Node* const item : read_texts(table, "answers")) {
    const std::string label = "mqtt.answers " + in_quotes(item->text);
    if (item->text.empty() || !is_filter(item->text)) {
      report.error(item->place,
                   label + " is no topic filter; '+' must be a whole part, '#' the last one, as in \"app/#\"");
    } else if (item->text.starts_with('$')) {
      report.error(item->place, label + " begins with '$', where nobody but the broker publishes; leave it out");
    } else if (item->text.starts_with(base + "/") || item->text == base) {
      report.error(item->place, label + " lies inside of base, where no answer is sent to; name topics outside of " +
                                    in_quotes(base) + ", such as \"app/#\"");
    }
  }
}

/// Its entities take their values from `state`.
void check_home_assistant(const Node& table, const Mqtt& mqtt, Report& report) {
  const std::string& prefix = mqtt.home_assistant;
  if (prefix.empty()) {
    return;
  }
  const std::string label = "mqtt.home_assistant " + in_quotes(prefix);
  const Place place = place_of(table, "home_assistant");
  if (!is_topic(prefix)) {
    report.error(
        place, label + " must be a topic without '+', '#', a leading '$', or an empty part, such as \"homeassistant\"");
  } else if (prefix == mqtt.base || prefix.starts_with(mqtt.base + "/")) {
    report.error(place, label + " lies inside of base, whose topics are the gateways' own; take the prefix that Home " +
                            "Assistant has, such as \"homeassistant\"");
  }
  if (!mqtt.state) {
    report.error(place, "mqtt.home_assistant needs state = true, where its values come from");
  }
  if (mqtt.version == MqttVersion::v3_1_1) {
    report.warning(place_of(table, "version"),
                   "mqtt.version \"3.1.1\" lets a broker keep for ever what it was told last: of a gateway that died "
                   "without the broker's notice, home_assistant shows values again for expiry whenever it starts, and "
                   "goes on to offer commands; leave version out where the broker knows MQTT 5");
  }
}

/// A topic that waits for min_interval must not expire meanwhile: live topics are published at a third of `expiry`.
void check_expiry(const Node& table, const Mqtt& mqtt, Report& report) {
  const bool lasts = mqtt.expiry == canopen::Duration::zero() || mqtt.expiry >= 3 * mqtt.min_interval;
  if (table.find("expiry") != nullptr && !lasts) {
    report.error(place_of(table, "expiry"), "mqtt.expiry must be at least three times min_interval (" +
                                                to_text(mqtt.expiry) + ", " + to_text(mqtt.min_interval) +
                                                "), else values expire between two messages");
  }
}

/// What reads as a value shows a lost drive as one that lives.
void check_stale_payload(const Node& table, const Mqtt& mqtt, Report& report) {
  const std::string& text = mqtt.stale_payload;
  const bool number = !text.empty() && text.find_first_not_of("0123456789+-.eE") == std::string::npos &&
                      text.find_first_of("0123456789") != std::string::npos;
  if (number || text == "true" || text == "false") {
    report.warning(place_of(table, "stale_payload"),
                   "mqtt.stale_payload " + in_quotes(text) +
                       " looks like a value, so nobody can tell a lost drive by it; take a word that no signal has");
  }
}

}  // namespace

std::optional<Mqtt> read_mqtt(const Node& root, const std::filesystem::path& directory, bool with_secrets,
                              Report& report) {
  const Node* const table = read_table(root, "mqtt");
  if (table == nullptr) {
    return std::nullopt;
  }
  Mqtt mqtt = mqtt_section().read(*table);
  check_brokers(*table, mqtt, report);
  check_base(*table, mqtt.base, report);
  check_answers(*table, mqtt.base, report);
  check_stale_payload(*table, mqtt, report);
  check_home_assistant(*table, mqtt, report);
  if (mqtt.max_interval < mqtt.min_interval) {
    const auto* const key = table->find("max_interval") != nullptr ? "max_interval" : "min_interval";
    report.error(place_of(*table, key), "mqtt.max_interval is shorter than min_interval (" +
                                            to_text(mqtt.max_interval) + ", " + to_text(mqtt.min_interval) + ")");
  }
  if (table->find("expiry") == nullptr) {
    mqtt.expiry = default_expiry(mqtt.max_interval);
  }
  check_expiry(*table, mqtt, report);
  if (!mqtt.password_file.empty()) {
    if (mqtt.username.empty()) {
      report.error(place_of(*table, "password_file"), "mqtt.password_file needs username");
    }
    take_password(*table, mqtt, directory, with_secrets, report);
  }
  take_tls_files(*table, mqtt, directory, with_secrets, report);
  return mqtt;
}

}  // namespace config
