#include "canopen/bus/second_master.h"

#include <algorithm>
#include <optional>

#include "canopen/nmt.h"

namespace canopen {
namespace {

std::string nmt_text(std::uint8_t command, std::uint8_t node) {
  const std::optional<NmtCommand> known = nmt_command_of(command);
  const std::string what = known ? std::string(name_of(*known)) : "command " + std::to_string(command);
  return "NMT commands (" + what + " to " + (node == 0 ? "all nodes" : "node " + std::to_string(node)) + ")";
}

}  // namespace

bool SecondMaster::hear(MasterSign sign, TimePoint at, std::uint8_t node, std::uint8_t command) noexcept {
  Heard& heard = of(sign);
  heard.last = at;
  if (heard.there) {
    return false;
  }
  heard = {.there = true, .node = node, .command = command, .last = at};
  return true;
}

bool SecondMaster::forget(TimePoint now) noexcept {
  bool changed = false;
  for (Heard& heard : heard_) {
    if (heard.there && now - heard.last >= kForgotten) {
      heard = {};
      changed = true;
    }
  }
  return changed;
}

bool SecondMaster::there() const noexcept {
  return std::any_of(heard_.begin(), heard_.end(), [](const Heard& heard) { return heard.there; });
}

std::string SecondMaster::text() const {
  std::string what;
  const auto add = [&what](const std::string& more) { what += (what.empty() ? "" : ", ") + more; };
  if (const Heard& nmt = of(MasterSign::nmt); nmt.there) {
    add(nmt_text(nmt.command, nmt.node));
  }
  if (const Heard& sdo = of(MasterSign::sdo); sdo.there) {
    add("SDO requests (to node " + std::to_string(sdo.node) + ")");
  }
  if (const Heard& rpdo = of(MasterSign::rpdo); rpdo.there) {
    add("RPDOs (to node " + std::to_string(rpdo.node) + "), unless a TPDO of another drive has that identifier");
  }
  if (of(MasterSign::sync).there) {
    add("SYNC beside ours");
  }
  return what.empty() ? what : "another master or a tool is on the bus: it sends " + what;
}

}  // namespace canopen
