#include "config/site/site.h"

#include <algorithm>

#include "config/schema/complaint.h"
#include "config/site/endpoint.h"
#include "config/site/site_keys.h"
#include "config/text.h"
#include "config/toml/document.h"

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
  const Node* const interface = table.find("interface");
  const bool stated = interface != nullptr && interface->kind == NodeKind::text;
  if ((stated || !bus.interface.empty()) && !is_interface(bus.interface)) {
    report.error(
        place_of(table, stated ? "interface" : "name"),
        where + in_quotes(bus.interface) + " is no interface name; give `interface` 1 to 15 letters or digits");
  }
}

/// The good values of a list, each with where it stands; wrong ones have their finding.
template <class T>
std::vector<std::pair<T, const Node*>> good_items(const Node& table, std::string_view key, const Form<T>& form) {
  std::vector<std::pair<T, const Node*>> items;
  for (const Node* const item : read_texts(table, key)) {
    if (auto value = form.read(*item, Complaint::silent()); value.has_value()) {
      items.emplace_back(*std::move(value), item);
    }
  }
  return items;
}

void check_listen(const Node& table, Report& report) {
  const auto items = good_items(table, "listen", endpoint());
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (std::size_t k = 0; k < items.size(); ++k) {
      const auto& [outer, outer_item] = items[k];
      const auto& [inner, inner_item] = items[i];
      // Of two that cover each other the later one has the finding.
      if (k != i && covers(outer, inner) && (k < i || !covers(inner, outer))) {
        report.error(inner_item->place, "modbus.listen " + in_quotes(inner_item->text) +
                                            (covers(inner, outer) ? " stands there twice, as " : " is contained in ") +
                                            in_quotes(outer_item->text) + "; leave one of them out");
        break;
      }
    }
  }
}

/// A link-local address is one only together with an interface, which an entry does not name: bind() answers EINVAL.
void check_link_local(const Node& table, Report& report) {
  for (const auto& [entry, item] : good_items(table, "listen", endpoint())) {
    if (is_link_local(entry)) {
      report.error(item->place, "modbus.listen " + in_quotes(item->text) +
                                    " is a link-local address and can never be bound without its interface; take "
                                    "another address of this machine, or [::] for all");
    }
  }
}

/// Clients that cannot connect cannot write, whatever write_from says of them.
void check_access(const Node& table, const Modbus& modbus, Report& report) {
  if (modbus.read_from.empty()) {
    report.warning(place_of(table, "read_from"), "modbus.read_from is empty, so nobody can connect");
    return;
  }
  const Node* const stated = table.find("read_from");
  const auto readers = good_items(table, "read_from", network());
  if (stated != nullptr && (stated->kind != NodeKind::list || readers.size() != stated->items.size())) {
    return;  // it has its finding, and what was meant is not known
  }
  for (const auto& [writer, item] : good_items(table, "write_from", network())) {
    if (std::none_of(modbus.read_from.begin(), modbus.read_from.end(),
                     [&from = writer](const Network& read) { return meet(read, from); })) {
      report.warning(item->place, "modbus.write_from " + in_quotes(item->text) +
                                      " lies outside of read_from, so its clients cannot connect; add it there");
    }
  }
}

}  // namespace

Gateway read_gateway(const Node& root, const std::string& host_name, Report& report) {
  const Node* const table = read_table(root, "gateway");
  const bool stated = table != nullptr && table->find("name") != nullptr;
  Gateway gateway = table == nullptr ? Gateway{} : gateway_section().read(*table);
  if (!stated) {
    gateway.name = from_host_name(host_name);
    if (!is_name(gateway.name)) {
      report.error(root.place, "the host's name is no name for a gateway; write [gateway] name = \"…\"");
    }
  }
  return gateway;
}

std::vector<Bus> read_buses(const Node& root, Report& report) {
  std::vector<Bus> buses;
  for (const Node* const table : read_tables(root, "bus")) {
    Bus bus = bus_section().read(*table);
    if (table->find("interface") == nullptr) {
      bus.interface = bus.name;
    }
    check_bus(*table, buses, bus, report);
    buses.push_back(std::move(bus));
  }
  return buses;
}

std::optional<Modbus> read_modbus(const Node& root, Report& report) {
  const Node* const table = read_table(root, "modbus");
  if (table == nullptr) {
    return std::nullopt;
  }
  Modbus modbus = modbus_section().read(*table);
  if (modbus.listen.empty()) {
    report.error(place_of(*table, "listen"), "modbus.listen is empty; leave [modbus] out where no Modbus is wanted");
  }
  if (modbus.on_stale == OnStale::zero) {
    report.warning(place_of(*table, "on_stale"),
                   "modbus.on_stale = \"zero\" shows a lost drive as one that stands still");
  }
  check_listen(*table, report);
  check_link_local(*table, report);
  check_access(*table, modbus, report);
  return modbus;
}

}  // namespace config
