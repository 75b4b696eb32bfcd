#pragma once

#include <boost/json/parse.hpp>
#include <cstdlib>
#include <set>
#include <string>
#include <utility>

#include "config/load.h"
#include "daemon/map.h"

// What holds for every configuration that was read, whatever its text.

namespace config {

inline void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

inline void require_signal(const Drive& drive, std::size_t position) {
  const Signal& signal = drive.signals[position];
  require(signal.scale > 0.0 && signal.decimals <= 9);
  require(!signal.min || !signal.max || *signal.min <= *signal.max);
  if (signal.derived) {
    require(signal.derived->from < position && !drive.signals[signal.derived->from].derived);
    require(signal.access == Access::read);
  }
  const ModbusPlace& place = signal.modbus;
  require(place.kind == ModbusKind::none || place.address + place.count <= 65536);
  require(place.kind == ModbusKind::none || place.address + place.count <= 1000 || place.address >= 1100);
  require(place.count == 1 || place.address % 2 == 0);
  require(drive.unit || place.kind == ModbusKind::none || signal.modbus.count >= 1);
  require(signal.source.kind != SourceKind::rpdo || signal.access == Access::write);
  require(signal.source.kind != SourceKind::tpdo || readable(signal.access));
}

inline void require_drive(const Model& model, const Drive& drive) {
  require(drive.bus < model.buses.size());
  require(drive.node.node >= 1 && drive.node.node <= 127);
  require(!drive.unit || (*drive.unit >= 1 && *drive.unit <= 247));
  require(drive.node.error_control.heartbeat_timeout > drive.node.error_control.heartbeat);
  for (const auto* const pdos : {&drive.node.tpdos, &drive.node.rpdos}) {
    for (const canopen::PdoSettings& pdo : *pdos) {
      unsigned bits = 0;
      for (const canopen::MappedObject& field : pdo.mapping) {
        bits += field.bits;
      }
      require(bits >= 1 && bits <= 64);
      require(pdo.cob_id > 0x180 && pdo.cob_id < 0x6E0);
    }
  }
  std::set<std::pair<bool, unsigned>> taken;
  for (std::size_t i = 0; i < drive.signals.size(); ++i) {
    require_signal(drive, i);
    const ModbusPlace& place = drive.signals[i].modbus;
    for (unsigned k = 0; place.kind != ModbusKind::none && k < place.count; ++k) {
      require(taken.emplace(place.kind == ModbusKind::bit, place.address + k).second);
    }
  }
}

inline void require_sound(const Loaded& loaded) {
  require(loaded.model.has_value() != has_errors(loaded.findings));
  for (const Finding& finding : loaded.findings) {
    require(!finding.file.empty() && finding.line >= 1 && finding.column >= 1);
    require(to_string(finding).find('\n') == std::string::npos);
  }
  if (!loaded.model) {
    return;
  }
  for (const Drive& drive : loaded.model->drives) {
    require_drive(*loaded.model, drive);
  }
  using gateway::MapFormat;
  for (const auto format : {MapFormat::table, MapFormat::csv, MapFormat::markdown}) {
    require(!render_map(*loaded.model, format).empty());
  }
  boost::system::error_code unreadable;
  require(boost::json::parse(render_map(*loaded.model, MapFormat::json), unreadable).is_object() && !unreadable);
  require(summary(*loaded.model).starts_with("ok: "));
}

}  // namespace config
