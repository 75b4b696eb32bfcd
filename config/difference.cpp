#include "config/difference.h"

#include <algorithm>

namespace config {
namespace {

bool is_same_drive(const Drive& before, const Drive& now, const Positions& buses) {
  if (buses.at(now.bus) != before.bus) {
    return false;
  }
  Drive moved = before;
  moved.bus = now.bus;
  return moved == now;
}

std::vector<std::string> keys_of(const Gateway& before, const Gateway& now) {
  std::vector<std::string> keys;
  const auto note = [&keys](const char* key, bool same) {
    if (!same) {
      keys.emplace_back(key);
    }
  };
  note("name", before.name == now.name);
  note("state_dir", before.state_dir == now.state_dir);
  note("control", before.control == now.control);
  note("journal", before.journal == now.journal);
  return keys;
}

std::size_t kept(const Positions& from) {
  return static_cast<std::size_t>(std::ranges::count_if(from, [](const auto& one) { return one.has_value(); }));
}

}  // namespace

Difference difference(const Model& before, const Model& now) {
  Difference difference;
  for (const Bus& bus : now.buses) {
    const auto found = find_named(before.buses, bus.name);
    difference.buses.push_back(found && before.buses[*found] == bus ? found : std::nullopt);
  }
  for (const Drive& drive : now.drives) {
    const auto found = find_named(before.drives, drive.name);
    const bool same = found && is_same_drive(before.drives[*found], drive, difference.buses);
    difference.drives.push_back(same ? found : std::nullopt);
  }
  difference.gateway = keys_of(before.gateway, now.gateway);
  difference.modbus = before.modbus != now.modbus;
  difference.mqtt = before.mqtt != now.mqtt;
  difference.http = before.http != now.http;
  difference.recorder = before.recorder != now.recorder;
  return difference;
}

bool is_none(const Difference& difference, const Model& before) {
  const auto all_kept = [](const Positions& from, std::size_t size) {
    return from.size() == size && kept(from) == size;
  };
  return all_kept(difference.drives, before.drives.size()) && all_kept(difference.buses, before.buses.size()) &&
         difference.gateway.empty() && !difference.modbus && !difference.mqtt && !difference.http &&
         !difference.recorder;
}

}  // namespace config
