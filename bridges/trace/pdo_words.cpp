#include <algorithm>
#include <array>
#include <string>

#include "bridges/trace/object_words.h"
#include "bridges/trace/words.h"
#include "canopen/hex.h"
#include "canopen/node/pdo.h"

namespace trace {
namespace {

using canopen::MappedObject;
using canopen::Raw;

std::string field_words(const config::Drive& drive, const MappedObject& mapped, PdoWay way, Raw raw) {
  if (const config::Signal* const signal = find_signal(drive, mapped.object, way)) {
    return signal->name + " " + signal_value(drive, *signal, canopen::normalise(signal->type, raw));
  }
  const Raw cut = mapped.bits >= 64 ? raw : raw & ((Raw{1} << mapped.bits) - 1);
  const std::string_view unused = mapped.use == canopen::FieldUse::unused && way == PdoWay::receive ? " (unused)" : "";
  return to_string(mapped.object) + " 0x" + canopen::hex(cut, (mapped.bits + 3U) / 4U).append(unused);
}

std::string values_of_pdo(const config::Drive& drive, const canopen::PdoSettings& pdo, const Entry& entry) {
  const canopen::PdoPlan plan(pdo.mapping);
  const auto bytes = entry.frame.bytes();
  std::array<Raw, canopen::kMaxPdoFields> values{};
  if (!plan.decode(bytes, values)) {
    return "too short, " + std::to_string(bytes.size()) + " of " + std::to_string(plan.byte_count()) +
           " bytes: " + bytes_text(bytes);
  }
  std::string text;
  for (std::size_t i = 0; i < pdo.mapping.size(); ++i) {
    if (!canopen::is_dummy(pdo.mapping[i].object)) {
      text += (text.empty() ? "" : ", ") + field_words(drive, pdo.mapping[i], entry.way, values.at(i));
    }
  }
  if (bytes.size() > plan.byte_count()) {
    text += "; beyond its mapping " + bytes_text(bytes.subspan(plan.byte_count()));
  }
  return text;
}

}  // namespace

std::string pdo_words(const config::Drive* drive, const Entry& entry) {
  if (entry.frame.remote) {
    return "asked for";
  }
  if (drive == nullptr || !entry.mapping) {
    return bytes_text(entry.frame.bytes()) + (drive == nullptr ? "" : " (not configured)");
  }
  const auto& pdos = entry.way == PdoWay::transmit ? drive->node.tpdos : drive->node.rpdos;
  const canopen::PdoSettings& pdo = pdos.at(*entry.mapping);
  return pdo.mapping.empty() ? bytes_text(entry.frame.bytes()) + " (mapping not known)"
                             : values_of_pdo(*drive, pdo, entry);
}

}  // namespace trace
