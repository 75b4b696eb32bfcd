#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "config/schema/complaint.h"
#include "config/site/endpoint.h"
#include "config/site/site.h"
#include "config/site/site_keys.h"

namespace config {
namespace {

void check_http_listen(const Node& table, const Endpoint& listen, const std::optional<Modbus>& modbus, Report& report) {
  const std::string text = "http.listen " + in_quotes(endpoint().show(listen));
  if (is_link_local(listen)) {
    report.error(place_of(table, "listen"), text +
                                                " is a link-local address and can never be bound without its "
                                                "interface; take another address of this machine, or [::] for all");
  }
  const auto meets = [&listen](const Endpoint& other) { return covers(listen, other) || covers(other, listen); };
  if (modbus && std::any_of(modbus->listen.begin(), modbus->listen.end(), meets)) {
    report.error(place_of(table, "listen"), text + " is what modbus.listen has already; take another port");
  }
}

bool is_of_this_machine(const Network& network) {
  return covers(Network{"127.0.0.0", 8}, network) || covers(Network{"::1", 128}, network);
}

bool is_for_others(const Endpoint& listen) {
  return can_arrive({"192.0.2.0", 24}, listen) || can_arrive({"2001:db8::", 32}, listen);
}

/// Who may read and cannot come, and the other way round.
void check_readers(const Node& table, const Http& http, Report& report) {
  if (http.read_from.empty()) {
    report.warning(place_of(table, "read_from"), "http.read_from is empty, so nobody can connect");
  } else if (table.find("read_from") == nullptr && is_for_others(http.listen)) {
    report.warning(place_of(table, "listen"),
                   "http.listen can be reached from other machines, but read_from, which is left out, lets only this "
                   "one read; name their networks there");
  }
  for (const Node* const item : read_texts(table, "read_from")) {
    const auto from = network().read(*item, Complaint::silent());
    if (from && !is_of_this_machine(*from) && !can_arrive(*from, http.listen)) {
      report.warning(item->place, "http.read_from " + in_quotes(item->text) + " cannot reach http.listen " +
                                      in_quotes(endpoint().show(http.listen)) +
                                      "; listen on an address that it can reach");
    }
  }
}

}  // namespace

std::optional<Http> read_http(const Node& root, const std::optional<Modbus>& modbus, Report& report) {
  const Node* const table = read_table(root, "http");
  if (table == nullptr) {
    return std::nullopt;
  }
  Http http = http_section().read(*table);
  check_http_listen(*table, http.listen, modbus, report);
  check_readers(*table, http, report);
  return http;
}

}  // namespace config
