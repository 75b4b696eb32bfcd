#include "daemon/control/bus_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <cstdint>
#include <vector>

namespace gateway::control {
namespace {

namespace json = boost::json;
using Row = std::vector<std::string>;

const json::value& of(const json::object& object, std::string_view name) {
  static const json::value nothing;
  const json::value* const found = object.if_contains(json::string_view(name.data(), name.size()));
  return found == nullptr ? nothing : *found;
}

std::optional<double> number_of(const json::object& object, std::string_view name) {
  const json::value& value = of(object, name);
  return value.is_number() ? std::optional(value.to_number<double>()) : std::nullopt;
}

std::string text_in(const json::object& object, std::string_view name) {
  const json::string* const text = of(object, name).if_string();
  return text == nullptr ? "-" : std::string(text->data(), text->size());
}

/// With the factor of a unit; a dash for what is not known.
std::string figure(const std::optional<double>& value, double factor, int digits, std::string_view unit) {
  return value ? fmt::format("{:.{}f}{}", *value * factor, digits, unit) : "-";
}

std::string whole(const json::object& object, std::string_view name) {
  return figure(number_of(object, name), 1, 0, "");
}

std::string milliseconds(const json::object& object, std::string_view name) {
  constexpr double kFactor = 1000;
  return figure(number_of(object, name), kFactor, 1, " ms");
}

std::string range(const json::object& object, std::string_view name, double factor, int digits, std::string_view unit) {
  const json::object* const range = of(object, name).if_object();
  return range == nullptr ? "-"
                          : figure(number_of(*range, "least"), factor, digits, "") + " to " +
                                figure(number_of(*range, "most"), factor, digits, unit);
}

std::string aligned(const std::vector<Row>& rows) {
  std::string out;
  for (const Row& row : rows) {
    std::string line = "  ";
    for (std::size_t i = 0; i < row.size(); ++i) {
      std::size_t width = 0;
      for (const Row& other : rows) {
        width = std::max(width, other[i].size());
      }
      line += fmt::format("{:<{}}  ", row[i], width);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

/// A table of the list with this name; empty where the list is.
template <class RowOf>
std::string table_of(const json::object& bus, std::string_view name, Row head, RowOf row_of) {
  std::vector<Row> rows{std::move(head)};
  if (const json::array* const list = of(bus, name).if_array()) {
    for (const json::value& each : *list) {
      if (const json::object* const entry = each.if_object()) {
        rows.push_back(row_of(*entry));
      }
    }
  }
  return rows.size() == 1 ? "" : aligned(rows);
}

Row node_row(const json::object& node) {
  const json::object* const margin = of(node, "margin").if_object();
  const json::object* const found = of(node, "sdo").if_object();
  const json::object sdo = found == nullptr ? json::object() : *found;
  return {whole(node, "node"),
          text_in(node, "drive"),
          milliseconds(node, "timeout"),
          milliseconds(node, "longest_gap"),
          margin == nullptr ? "-" : figure(number_of(*margin, "least"), 100, 0, " %"),
          milliseconds(sdo, "p50"),
          milliseconds(sdo, "p99"),
          whole(sdo, "count")};
}

Row cob_id_row(const json::object& cob_id) {
  return {text_in(cob_id, "cob_id"), milliseconds(cob_id, "p50"), milliseconds(cob_id, "p99"),
          milliseconds(cob_id, "worst"), whole(cob_id, "count")};
}

std::string bus_text(const json::object& bus) {
  std::string out = fmt::format("bus {}, {}\n", text_in(bus, "name"), text_in(bus, "interface"));
  const json::object* const suspicion = of(bus, "suspicion").if_object();
  out += suspicion == nullptr
             ? "  suspicion: none\n"
             : fmt::format("  suspicion since {}: {}\n", text_in(*suspicion, "since"), text_in(*suspicion, "text"));
  out += fmt::format("  load {}, transmit errors {}, receive errors {}, error frames {} of 10000\n",
                     range(bus, "load", 100, 1, " %"), range(bus, "transmit_errors", 1, 0, ""),
                     range(bus, "receive_errors", 1, 0, ""), range(bus, "error_frames", 1, 0, ""));
  if (const json::object* const burst = of(bus, "burst").if_object()) {
    out += fmt::format("  longest burst {} frames, {}\n", whole(*burst, "frames"), milliseconds(*burst, "time"));
  }
  return out +
         table_of(bus, "nodes", {"node", "drive", "time-out", "longest gap", "margin", "SDO p50", "SDO p99", "answers"},
                  node_row) +
         table_of(bus, "cob_ids", {"COB-ID", "p50", "p99", "worst", "periods"}, cob_id_row);
}

}  // namespace

std::optional<std::string> bus_table(std::string_view buses) {
  json::error_code failed;
  const json::value read = json::parse(json::string_view(buses.data(), buses.size()), failed);
  const json::array* const list = failed ? nullptr : read.if_array();
  if (list == nullptr) {
    return std::nullopt;
  }
  std::string out;
  for (const json::value& each : *list) {
    if (const json::object* const bus = each.if_object()) {
      out += bus_text(*bus);
    }
  }
  return out.empty() ? std::nullopt : std::optional(out);
}

}  // namespace gateway::control
