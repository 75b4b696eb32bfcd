#include "daemon/reload/effective_model.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>

#include "config/address_map.h"
#include "config/difference.h"

namespace gateway {
namespace {

using config::Drive;
using config::Model;

std::set<std::uint32_t> pdo_cob_ids(const Drive& drive) {
  std::set<std::uint32_t> ids;
  for (const std::vector<canopen::PdoSettings>* pdos : {&drive.node.tpdos, &drive.node.rpdos}) {
    for (const canopen::PdoSettings& pdo : *pdos) {
      if (pdo.cob_id != 0) {
        ids.insert(pdo.cob_id);
      }
    }
  }
  return ids;
}

bool collide_on_bus(const Drive& one, const Drive& other) {
  const std::set<std::uint32_t> taken = pdo_cob_ids(other);
  return one.node.node == other.node.node ||
         std::ranges::any_of(pdo_cob_ids(one), [&taken](std::uint32_t id) { return taken.contains(id); });
}

bool collide_on_modbus(const Drive& one, const Drive& other) {
  return (one.unit && one.unit == other.unit) ||
         (one.flat && other.flat && *one.flat < *other.flat + config::kFlatBlock &&
          *other.flat < *one.flat + config::kFlatBlock);
}

/// Finds what stays as it is, and what has to wait for that: each makes more of the other until nothing is added.
class Choice {
 public:
  Choice(const Model& in_use, const Model& wanted, const std::vector<bool>& turns)
      : in_use_(in_use),
        wanted_(wanted),
        same_(config::difference(in_use, wanted)),
        stays_(in_use.drives.size(), false),
        waits_(wanted.drives.size(), false),
        bus_stays_(in_use.buses.size(), false),
        bus_waits_(wanted.buses.size(), false) {
    for (std::size_t i = 0; i < in_use.drives.size(); ++i) {
      stays_[i] = turns[i] && !is_same(i);
    }
    do {
      grew_ = false;
      look_at_buses();
      look_at_modbus();
      look_at_drives();
    } while (grew_);
  }

  [[nodiscard]] EffectiveModel model(const std::vector<bool>& turns) const;

 private:
  [[nodiscard]] std::vector<config::Bus> buses() const;
  [[nodiscard]] bool is_same(std::size_t in_use) const {
    return std::ranges::find(same_.drives, std::optional(in_use)) != same_.drives.end();
  }
  [[nodiscard]] bool is_same_bus(std::size_t in_use) const {
    return std::ranges::find(same_.buses, std::optional(in_use)) != same_.buses.end();
  }
  void set(std::vector<bool>& marks, std::size_t at) {
    grew_ = grew_ || !marks[at];
    marks[at] = true;
  }
  void look_at_buses();
  void look_at_modbus();
  void look_at_drives();
  /// Something that stays has what the wanted drive is to have.
  [[nodiscard]] bool is_in_the_way(const Drive& wanted) const;

  const Model& in_use_;
  const Model& wanted_;
  config::Difference same_;
  std::vector<bool> stays_;      ///< Drives in use that keep a section which is another one, or gone.
  std::vector<bool> waits_;      ///< Wanted drives.
  std::vector<bool> bus_stays_;  ///< Likewise.
  std::vector<bool> bus_waits_;
  bool modbus_stays_ = false;
  bool grew_ = false;
};

// All of a bus, or nothing: heartbeats and times of its drives are the bus's.
void Choice::look_at_buses() {
  for (std::size_t i = 0; i < in_use_.drives.size(); ++i) {
    if (stays_[i] && !is_same_bus(in_use_.drives[i].bus)) {
      set(bus_stays_, in_use_.drives[i].bus);
    }
  }
  for (std::size_t i = 0; i < in_use_.drives.size(); ++i) {
    if (bus_stays_[in_use_.drives[i].bus]) {
      set(stays_, i);
    }
  }
  for (std::size_t i = 0; i < wanted_.buses.size(); ++i) {
    for (std::size_t k = 0; k < in_use_.buses.size(); ++k) {
      if (bus_stays_[k] && (wanted_.buses[i].name == in_use_.buses[k].name ||
                            (wanted_.buses[i].interface == in_use_.buses[k].interface &&
                             wanted_.buses[i].interface != config::kVirtualInterface))) {
        set(bus_waits_, i);
      }
    }
  }
}

void Choice::look_at_modbus() {
  for (std::size_t i = 0; i < in_use_.drives.size(); ++i) {
    const Drive& drive = in_use_.drives[i];
    if (stays_[i] && same_.modbus && wanted_.modbus &&
        ((drive.unit && wanted_.modbus->flat_unit == drive.unit) || (drive.flat && !wanted_.modbus->flat_unit))) {
      grew_ = grew_ || !modbus_stays_;
      modbus_stays_ = true;
    }
  }
}

void Choice::look_at_drives() {
  for (std::size_t i = 0; i < wanted_.drives.size(); ++i) {
    if (same_.drives[i] || !(bus_waits_[wanted_.drives[i].bus] || is_in_the_way(wanted_.drives[i]))) {
      continue;
    }
    set(waits_, i);
    if (const auto old = config::find_named(in_use_.drives, wanted_.drives[i].name)) {
      set(stays_, *old);
    }
  }
}

bool Choice::is_in_the_way(const Drive& wanted) const {
  const auto flat = modbus_stays_ && in_use_.modbus ? in_use_.modbus->flat_unit : std::nullopt;
  if ((flat && wanted.unit == flat) || (modbus_stays_ && wanted.flat && !flat)) {
    return true;
  }
  for (std::size_t i = 0; i < in_use_.drives.size(); ++i) {
    const Drive& drive = in_use_.drives[i];
    const bool one_bus = in_use_.buses[drive.bus].name == wanted_.buses[wanted.bus].name;
    if (stays_[i] &&
        (drive.name == wanted.name || collide_on_modbus(drive, wanted) || (one_bus && collide_on_bus(drive, wanted)))) {
      return true;
    }
  }
  return false;
}

/// A bus that stays has the place of the one that waits for it: the gateway's Modbus unit shows buses by their places.
std::vector<config::Bus> Choice::buses() const {
  std::vector<config::Bus> buses;
  std::vector<bool> added(in_use_.buses.size(), false);
  const auto add_first = [&](const auto& is_it) {
    for (std::size_t k = 0; k < in_use_.buses.size(); ++k) {
      if (bus_stays_[k] && !added[k] && is_it(in_use_.buses[k])) {
        added[k] = true;
        buses.push_back(in_use_.buses[k]);
        return true;
      }
    }
    return false;
  };
  for (std::size_t i = 0; i < wanted_.buses.size(); ++i) {
    const config::Bus& wanted = wanted_.buses[i];
    if (!bus_waits_[i]) {
      buses.push_back(wanted);
    } else if (!add_first([&](const config::Bus& bus) { return bus.name == wanted.name; })) {
      add_first([&](const config::Bus& bus) {
        return bus.interface == wanted.interface && !config::find_named(wanted_.buses, bus.name);
      });
    }
  }
  while (add_first([](const config::Bus&) { return true; })) {
  }
  return buses;
}

EffectiveModel Choice::model(const std::vector<bool>& turns) const {
  EffectiveModel made{.model = wanted_, .waiting = {}};
  Model& model = made.model;
  model.buses.clear();
  model.drives.clear();
  if (modbus_stays_) {
    model.modbus = in_use_.modbus;
  }
  model.buses = buses();
  const auto add = [&model](Drive drive, const std::string& bus) {
    drive.bus = config::find_named(model.buses, bus).value();
    model.drives.push_back(std::move(drive));
  };
  // A drive that stays keeps its place among the others.
  std::vector<bool> added(in_use_.drives.size(), false);
  const auto add_old = [&](std::size_t i) {
    added[i] = true;
    add(in_use_.drives[i], in_use_.buses[in_use_.drives[i].bus].name);
    made.waiting.push_back({.name = in_use_.drives[i].name, .in_use = true, .turns = turns[i]});
  };
  for (std::size_t i = 0; i < wanted_.drives.size(); ++i) {
    const auto old = config::find_named(in_use_.drives, wanted_.drives[i].name);
    if (!waits_[i]) {
      add(wanted_.drives[i], wanted_.buses[wanted_.drives[i].bus].name);
    } else if (old) {
      add_old(*old);
    } else {
      made.waiting.push_back({.name = wanted_.drives[i].name});
    }
  }
  for (std::size_t i = 0; i < in_use_.drives.size(); ++i) {
    if (stays_[i] && !added[i]) {
      add_old(i);
    }
  }
  return made;
}

}  // namespace

EffectiveModel effective_model(const Model& in_use, const Model& wanted, const std::vector<bool>& turns) {
  return Choice(in_use, wanted, turns).model(turns);
}

}  // namespace gateway
