#include "config/load_site.h"

#include <algorithm>

#include "config/reader.h"
#include "config/text.h"

namespace config {
namespace {

// A network interface name is at most IFNAMSIZ - 1 bytes.
constexpr std::size_t kLongestInterface = 15;

/// The host's name without domain, in the letters that a gateway name may have.
std::string from_host_name(const std::string& host_name) {
  std::string name = host_name.substr(0, std::min(host_name.find('.'), std::size_t{32}));
  std::replace_if(name.begin(), name.end(), [](char c) { return !is_name(std::string_view(&c, 1)); }, '-');
  return name;
}

bool is_interface(const std::string& name) {
  return !name.empty() && name.size() <= kLongestInterface && name != "." && name != ".." &&
         std::all_of(name.begin(), name.end(),
                     [](char c) { return c > ' ' && c != '/' && c != ':' && static_cast<unsigned char>(c) < 0x7F; });
}

void check_bus(const Node& table, const std::vector<Bus>& before, const Bus& bus, Report& report) {
  const std::string where = "bus \"" + bus.name + "\": ";
  for (const Bus& other : before) {
    if (!bus.name.empty() && other.name == bus.name) {
      report.error(place_of(table, "name"), where + "there is another bus of this name");
    }
    if (other.interface == bus.interface && bus.interface != kVirtualInterface && !bus.interface.empty()) {
      report.error(place_of(table, "interface"),
                   where + "interface \"" + bus.interface + "\" is already that of bus \"" + other.name + "\"");
    }
  }
  if (!bus.interface.empty() && !is_interface(bus.interface)) {
    report.error(place_of(table, "interface"),
                 where + "\"" + bus.interface + "\" is no interface name; give `interface` 1 to 15 letters or digits");
  }
  if (!whole_milliseconds(bus.heartbeat)) {
    report.error(place_of(table, "heartbeat"), where + "heartbeat must be whole milliseconds");
  }
}

}  // namespace

Gateway read_gateway(const Node& root, const std::string& host_name, Report& report) {
  Gateway gateway{.name = from_host_name(host_name)};
  bool stated = false;
  if (const Node* const table = read_table(root, "gateway"); table != nullptr) {
    stated = table->find("name") != nullptr;
    take(gateway.name, read_text(*table, "name"));
  }
  if (!stated && !is_name(gateway.name)) {
    report.error(root.place, "the host's name is no name for a gateway; write [gateway] name = \"…\"");
  }
  return gateway;
}

std::vector<Bus> read_buses(const Node& root, Report& report) {
  std::vector<Bus> buses;
  for (const Node* const table : read_tables(root, "bus")) {
    Bus bus;
    bus.name = read_text(*table, "name").value_or("");
    bus.interface = read_text(*table, "interface").value_or(bus.name);
    bus.bitrate = read_as<std::uint32_t>(*table, "bitrate");
    take(bus.node_id, read_as<std::uint8_t>(*table, "node_id"));
    take(bus.heartbeat, read_duration(*table, "heartbeat"));
    take(bus.sync, read_duration(*table, "sync"));
    check_bus(*table, buses, bus, report);
    buses.push_back(std::move(bus));
  }
  return buses;
}

OnStale read_on_stale(const Node& table, OnStale standard) {
  const auto text = read_text(table, "on_stale");
  if (text == "hold") {
    return OnStale::hold;
  }
  if (text == "zero") {
    return OnStale::zero;
  }
  return text == "exception" ? OnStale::exception : standard;
}

}  // namespace config
