#include <algorithm>
#include <variant>

#include "config/endpoint.h"
#include "config/files.h"
#include "config/load_site.h"
#include "config/reader.h"

namespace config {
namespace {

void read_networks(const Node& table, std::string_view key, std::vector<Network>& networks, Report& report) {
  if (table.find(key) == nullptr) {
    return;
  }
  networks.clear();
  for (const Node* const item : read_texts(table, key)) {
    const auto network = parse_network(item->text);
    const std::string where = "modbus." + std::string(key) + " \"" + item->text + "\" ";
    if (!network.has_value()) {
      report.error(item->place, where + "must be a network such as \"192.168.1.0/24\" or one numeric address");
    } else if (const Network clean = masked(*network); clean.address != masked({network->address, 128}).address) {
      report.error(item->place, where + "has bits beyond its prefix; the network is \"" + clean.address + "/" +
                                    std::to_string(clean.prefix) + "\"");
    } else {
      networks.push_back(clean);
    }
  }
}

void read_listen(const Node& table, Modbus& modbus, Report& report) {
  const Node* const list = table.find("listen");
  if (list == nullptr || list->kind != NodeKind::list) {
    return;
  }
  modbus.listen.clear();
  for (const Node* const item : read_texts(table, "listen")) {
    const auto endpoint = parse_endpoint(item->text);
    if (!endpoint.has_value()) {
      report.error(item->place,
                   "modbus.listen \"" + item->text + "\" must be an address and a port, such as \"0.0.0.0:502\"");
    } else if (std::find(modbus.listen.begin(), modbus.listen.end(), *endpoint) != modbus.listen.end()) {
      report.error(item->place, "modbus.listen \"" + item->text + "\" stands there twice");
    } else {
      modbus.listen.push_back(*endpoint);
    }
  }
  if (list->items.empty()) {
    report.error(list->place, "modbus.listen is empty; leave [modbus] out where no Modbus is wanted");
  }
}

void read_broker(const Node& table, Mqtt& mqtt, Report& report) {
  const Node* const list = table.find("brokers");
  if (list == nullptr || list->kind != NodeKind::list) {
    return;
  }
  if (list->items.empty()) {
    report.error(list->place, "mqtt.brokers is empty; leave [mqtt] out where no MQTT is wanted");
  }
  if (list->items.size() > 1) {
    report.error(list->items[1].place, "mqtt.brokers: more than one broker is not supported by this version");
  }
  for (const Node* const item : read_texts(table, "brokers")) {
    constexpr std::string_view kScheme = "mqtt://";
    const std::string where = "mqtt.brokers \"" + item->text + "\" ";
    if (item->text.starts_with("mqtts://")) {
      report.error(item->place, where + "is not supported by this version; only mqtt:// is");
      continue;
    }
    const bool schemed = item->text.starts_with(kScheme);
    const auto endpoint = schemed ? parse_endpoint(std::string_view(item->text).substr(kScheme.size())) : std::nullopt;
    if (!endpoint.has_value()) {
      report.error(item->place, where + "must be mqtt://HOST:PORT, such as \"mqtt://127.0.0.1:1883\"");
    } else if (item == list->items.data()) {
      mqtt.broker = *endpoint;
    }
  }
}

void check_base(const Node& table, const std::string& base, Report& report) {
  const bool good = !base.empty() && !base.starts_with('/') && !base.ends_with('/') && !base.starts_with('$') &&
                    base.find_first_of("+#") == std::string::npos && base.find("//") == std::string::npos;
  if (!good) {
    report.error(place_of(table, "base"),
                 "mqtt.base \"" + base + "\" must be a topic without '+', '#', a leading '$', or an empty part");
  }
}

void read_password(const Node& table, const std::filesystem::path& directory, Mqtt& mqtt, Report& report) {
  const auto file = read_text(table, "password_file");
  if (!file.has_value()) {
    return;
  }
  if (mqtt.username.empty()) {
    report.error(place_of(table, "password_file"), "mqtt.password_file needs username");
  }
  auto content = read_file(directory / *file);
  if (const auto* failure = std::get_if<FileFailure>(&content); failure != nullptr) {
    report.error(place_of(table, "password_file"),
                 "mqtt.password_file \"" + *file + "\" cannot be read: " + failure->reason);
    return;
  }
  const std::string& password = std::get<std::string>(content);
  mqtt.password = password.substr(0, password.find_first_of("\r\n"));
}

}  // namespace

std::optional<Modbus> read_modbus(const Node& root, Report& report) {
  const Node* const table = read_table(root, "modbus");
  if (table == nullptr) {
    return std::nullopt;
  }
  Modbus modbus;
  read_listen(*table, modbus, report);
  take(modbus.max_clients, read_as<std::size_t>(*table, "max_clients"));
  take(modbus.idle_timeout, read_duration(*table, "idle_timeout"));
  read_networks(*table, "read_from", modbus.read_from, report);
  read_networks(*table, "write_from", modbus.write_from, report);
  modbus.word_order = read_text(*table, "word_order") == "little" ? WordOrder::little : WordOrder::big;
  return modbus;
}

std::optional<Mqtt> read_mqtt(const Node& root, const std::filesystem::path& directory, Report& report) {
  const Node* const table = read_table(root, "mqtt");
  if (table == nullptr) {
    return std::nullopt;
  }
  Mqtt mqtt;
  read_broker(*table, mqtt, report);
  take(mqtt.base, read_text(*table, "base"));
  check_base(*table, mqtt.base, report);
  take(mqtt.qos, read_as<int>(*table, "qos"));
  take(mqtt.state, read_boolean(*table, "state"));
  take(mqtt.signals, read_boolean(*table, "signals"));
  take(mqtt.min_interval, read_duration(*table, "min_interval"));
  take(mqtt.max_interval, read_duration(*table, "max_interval"));
  if (mqtt.max_interval < mqtt.min_interval) {
    report.error(place_of(*table, "max_interval"), "mqtt.max_interval is shorter than min_interval");
  }
  take(mqtt.username, read_text(*table, "username"));
  read_password(*table, directory, mqtt, report);
  return mqtt;
}

}  // namespace config
