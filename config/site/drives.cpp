#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "config/address_map.h"
#include "config/site/site.h"
#include "config/text.h"
#include "config/toml/document.h"

namespace config {
namespace {

constexpr unsigned kLastNode = 127;
constexpr unsigned kLastUnit = 247;

using Tables = std::vector<const Node*>;

std::string free_number(const std::set<unsigned>& taken, unsigned last) {
  for (unsigned number = 1; number <= last; ++number) {
    if (!taken.contains(number)) {
      return std::to_string(number) + " is free";
    }
  }
  return "none is free";
}

void check_names(const Model& model, const Tables& tables, Report& report) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < model.drives.size(); ++i) {
    const std::string& name = model.drives[i].name;
    if (!name.empty() && !seen.insert(name).second) {
      report.error(place_of(*tables[i], "name"), "drive \"" + name + "\": there is another drive of this name");
    }
  }
}

/// Node ids of one bus: each drive its own, and none the gateway's.
void check_nodes(const Model& model, const Tables& tables, std::size_t bus_number, Report& report) {
  const Bus& bus = model.buses[bus_number];
  std::set<unsigned> taken{bus.node_id};
  for (const Drive& drive : model.drives) {
    if (drive.bus == bus_number) {
      taken.insert(drive.node.node);
    }
  }
  std::map<unsigned, std::string> owners;
  if (bus.node_id != 0) {
    owners[bus.node_id] = "the gateway";
  }
  for (std::size_t i = 0; i < model.drives.size(); ++i) {
    const Drive& drive = model.drives[i];
    const unsigned node = drive.node.node;
    if (drive.bus != bus_number || node < 1 || node > kLastNode) {
      continue;
    }
    const auto [owner, first] = owners.try_emplace(node, "drive \"" + drive.name + "\"");
    if (!first) {
      report.error(place_of(*tables[i], "node"), "drive \"" + drive.name + "\": node " + std::to_string(node) +
                                                     " on bus \"" + bus.name + "\" is that of " + owner->second + "; " +
                                                     free_number(taken, kLastNode));
    }
  }
}

void check_units(const Model& model, const Node& root, const Tables& tables, Report& report) {
  std::set<unsigned> taken;
  for (const Drive& drive : model.drives) {
    taken.insert(drive.unit.value_or(0));
  }
  const auto flat = model.modbus ? model.modbus->flat_unit : std::nullopt;
  if (flat && taken.contains(*flat)) {
    const auto owner = std::ranges::find(model.drives, flat, &Drive::unit);
    taken.insert(*flat);
    report.error(place_of(*read_table(root, "modbus"), "flat_unit"),
                 "modbus.flat_unit " + std::to_string(*flat) + " is the Modbus unit of drive \"" + owner->name +
                     "\"; " + free_number(taken, kLastUnit));
  }
  taken.insert(flat.value_or(0));
  const auto states_unit = [&tables](std::size_t i) { return tables[i]->find("unit") != nullptr; };
  std::map<unsigned, std::size_t> owners;
  for (std::size_t i = 0; i < model.drives.size(); ++i) {
    const Drive& drive = model.drives[i];
    const unsigned unit = drive.unit.value_or(0);
    if (unit < 1 || unit > kLastUnit) {
      continue;
    }
    const auto [owner, first] = owners.try_emplace(unit, i);
    const bool stated = states_unit(i);
    // Two that have the unit of one node id on one bus have their finding already.
    if (!first && (stated || states_unit(owner->second) || model.drives[owner->second].bus != drive.bus)) {
      report.error(place_of(*tables[i], stated ? "unit" : "node"),
                   "drive \"" + drive.name + "\": Modbus unit " + std::to_string(unit) +
                       (stated ? "" : " (its node id, as no unit is given)") + " is that of drive \"" +
                       model.drives[owner->second].name + "\"; " + free_number(taken, kLastUnit));
    }
  }
}

bool overlap(std::uint16_t a, std::uint16_t b) {
  return a < b + kFlatBlock && b < a + kFlatBlock;
}

std::string free_base(const Model& model) {
  for (std::uint32_t base = 0; base + kFlatBlock <= kAddresses; base += kFlatBlock) {
    if (std::ranges::none_of(model.drives, [base](const Drive& drive) {
          return drive.flat && overlap(*drive.flat, static_cast<std::uint16_t>(base));
        })) {
      return std::to_string(base) + " is free";
    }
  }
  return "none is free";
}

void check_block(const Model& model, std::size_t number, const Node& table, Report& report) {
  const Drive& drive = model.drives[number];
  const Place place = place_of(table, "flat");
  const std::string where = "drive \"" + drive.name + "\": ";
  for (std::size_t i = 0; i < number; ++i) {
    const Drive& other = model.drives[i];
    if (other.flat && overlap(*other.flat, *drive.flat)) {
      report.error(place, where + "flat " + std::to_string(*drive.flat) + " overlaps " + std::to_string(*other.flat) +
                              ".." + std::to_string(*other.flat + kFlatBlock - 1) + " of drive \"" + other.name +
                              "\"; " + free_base(model));
      break;
    }
  }
  for (const Signal& signal : drive.signals) {
    if (signal.modbus.kind != ModbusKind::none && signal.modbus.address + signal.modbus.count > kFlatSignals) {
      report.warning(place, where + "signal \"" + signal.name + "\" at Modbus address " +
                                std::to_string(signal.modbus.address) + " is not on the flat unit, which shows 0..899");
    }
  }
}

/// The blocks of the drives on the flat unit.
void check_flat(const Model& model, const Node& root, const Tables& tables, Report& report) {
  if (!model.modbus) {
    return;  // As any unit.
  }
  // What is written wrong has its finding, and was written all the same.
  const Node& modbus = *read_table(root, "modbus");
  const bool has_unit = modbus.find("flat_unit") != nullptr;
  bool any = false;
  for (std::size_t i = 0; i < model.drives.size(); ++i) {
    const Drive& drive = model.drives[i];
    any = any || tables[i]->find("flat") != nullptr;
    if (drive.flat && !has_unit) {
      report.error(place_of(*tables[i], "flat"),
                   "drive \"" + drive.name + "\": flat needs modbus.flat_unit, the unit that shows it");
    } else if (drive.flat) {
      check_block(model, i, *tables[i], report);
    }
  }
  if (has_unit && !any) {
    report.warning(place_of(modbus, "flat_unit"), "modbus.flat_unit shows nothing: no drive has a base there (`flat`)");
  }
}

/// Where a drive states the COB-ID of a PDO; null where it does not.
const Node* stated_cob_id(const Node& drive, const std::string& pdo) {
  const Node* const table = read_table(drive, pdo);
  return table == nullptr ? nullptr : table->find("cob_id");
}

struct PdoOwner {
  std::size_t drive;
  std::string pdo;
};

void check_cob_ids(const Model& model, const Tables& tables, Report& report) {
  std::map<std::pair<std::size_t, std::uint32_t>, PdoOwner> owners;
  for (std::size_t i = 0; i < model.drives.size(); ++i) {
    const Drive& drive = model.drives[i];
    for (const auto& [kind, pdos] :
         {std::pair(SourceKind::tpdo, &drive.node.tpdos), std::pair(SourceKind::rpdo, &drive.node.rpdos)}) {
      for (const canopen::PdoSettings& pdo : *pdos) {
        const std::string name = to_text(Source{kind, pdo.number});
        const auto [owner, first] = owners.try_emplace({drive.bus, pdo.cob_id}, PdoOwner{i, name});
        const Drive& other = model.drives[owner->second.drive];
        // Drives of one node id share all of theirs, and have their finding already.
        if (!first && owner->second.drive != i && pdo.cob_id != 0 && other.node.node != drive.node.node) {
          const Node* const here = stated_cob_id(*tables[i], name);
          const Node* const there = stated_cob_id(*tables[owner->second.drive], owner->second.pdo);
          const Place at = here != nullptr ? here->place : there != nullptr ? there->place : tables[i]->place;
          report.error(at, "drive \"" + drive.name + "\": " + name + " has the COB-ID " + to_hex(pdo.cob_id) + " of " +
                               owner->second.pdo + " of drive \"" + other.name + "\"; give one of them another cob_id");
        }
      }
    }
  }
}

}  // namespace

void check_drives(const Model& model, const Node& root, Report& report) {
  const Tables tables = read_tables(root, "drive");
  check_names(model, tables, report);
  for (std::size_t bus = 0; bus < model.buses.size(); ++bus) {
    check_nodes(model, tables, bus, report);
  }
  check_units(model, root, tables, report);
  check_flat(model, root, tables, report);
  check_cob_ids(model, tables, report);
}

}  // namespace config
