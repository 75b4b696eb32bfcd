#include <fmt/format.h>

#include <optional>
#include <vector>

#include "canopen/node/pdo_times.h"
#include "canopen/node/wanted_objects.h"
#include "daemon/compare/remedy.h"
#include "daemon/compare/settings.h"

namespace gateway::compare {
namespace {

using canopen::PdoRole;
using canopen::PdoSettings;
using canopen::Raw;
using canopen::SetupItem;
using canopen::SetupPolicy;
using Level = config::Finding::Level;

/// `0x2030:03 16 bit`
std::string entry_text(Raw entry) {
  const canopen::ObjectAddress object{static_cast<std::uint16_t>(entry >> 16U), static_cast<std::uint8_t>(entry >> 8U)};
  return fmt::format("{} {} bit", canopen::to_string(object), entry & 0xFFU);
}

std::string mapping_text(const std::vector<Raw>& entries) {
  std::string text;
  for (const Raw entry : entries) {
    text += (text.empty() ? "" : ", ") + entry_text(entry);
  }
  return text.empty() ? "nothing" : text;
}

// What the next boot calls letter J.
void note_lack(DriveView& view, const std::string& why) {
  if (!why.empty()) {
    view.note(Level::error, why);
  }
}

/// False: the drive has no such communication object.
bool compare_cob_id(DriveView& view, PdoRole role, const PdoSettings& pdo, Level level) {
  SetupItem item = canopen::wanted_cob_id(role, pdo, pdo.cob_id);
  item.mask = ~canopen::kPdoRtrForbidden;
  const Reading found = view.read(item.object, item.type, item.name);
  if (found.kind != Reading::Kind::value) {
    return found.kind != Reading::Kind::absent;
  }
  if (((found.raw ^ item.wanted) & item.mask) == 0) {
    view.as_it_should();
    return true;
  }
  const bool off = (found.raw & canopen::kPdoInvalid) != 0;
  view.note(level, canopen::difference_text(item, found.raw) + (off ? " (bit 31: it is switched off)" : "") +
                       remedy_of(pdo.communication, view.drive()));
  return true;
}

/// What the drive has mapped, by the number that it shows; nothing: it cannot be compared, and why is noted.
std::optional<std::vector<Raw>> mapping_found(DriveView& view, const SetupItem& first, Raw number, Level level) {
  std::vector<Raw> found;
  for (Raw sub = 1; sub <= number; ++sub) {
    const canopen::ObjectAddress object{first.object.index, static_cast<std::uint8_t>(sub)};
    const Reading entry = view.read(object, canopen::DataType::u32, first.name);
    if (entry.kind == Reading::Kind::absent) {
      view.note(level, fmt::format("{} {}: the drive does not have it, although sub 0 says {}",
                                   canopen::to_string(object), first.name, number));
    }
    if (entry.kind != Reading::Kind::value) {
      return std::nullopt;
    }
    found.push_back(entry.raw);
  }
  return found;
}

void compare_mapping(DriveView& view, PdoRole role, const PdoSettings& pdo) {
  const std::vector<SetupItem> items = canopen::wanted_mapping(role, pdo);
  const SetupItem& count = items.front();
  const Level level = pdo.mapping_policy == SetupPolicy::assume ? Level::warning : Level::error;
  const Reading number = view.read(count.object, count.type, count.name);
  if (number.kind == Reading::Kind::absent) {
    note_lack(view, canopen::why_not_without_mapping(role, pdo));
  }
  if (number.kind != Reading::Kind::value) {
    return;
  }
  std::vector<Raw> wanted;
  for (std::size_t i = 1; i < items.size(); ++i) {
    wanted.push_back(items[i].wanted);
  }
  constexpr Raw kMostMapped = 64;  // CiA 301 §7.5.2.36; 254 and 255 are multiplexed PDOs.
  const bool multiplexed = number.raw > kMostMapped;
  const auto found = mapping_found(view, items.back(), multiplexed ? 0 : number.raw, level);
  if (!found) {
    return;
  }
  if (*found == wanted && !multiplexed) {
    view.as_it_should();
    return;
  }
  const std::string shown =
      multiplexed ? fmt::format("{} objects (254 and 255: multiplexed)", number.raw) : mapping_text(*found);
  view.note(level, fmt::format("0x{:04X} {} mapping: expected {}, found {}{}", count.object.index,
                               canopen::pdo_name(role, pdo), mapping_text(wanted), shown,
                               remedy_of(pdo.mapping_policy, view.drive())));
}

void compare_parameters(DriveView& view, PdoRole role, const PdoSettings& pdo, Level level, const std::string& remedy) {
  for (const SetupItem& item : canopen::wanted_parameters(role, pdo)) {
    const Reading::Kind read = view.compare(item, level, remedy);
    if (read == Reading::Kind::absent && item.object.sub == canopen::kPdoEventTimer) {
      note_lack(view, canopen::why_not_without_timer(role, pdo));
    }
  }
}

void compare_pdo(DriveView& view, PdoRole role, const PdoSettings& pdo) {
  const bool assumed = pdo.communication == SetupPolicy::assume;
  const Level level = assumed ? Level::warning : Level::error;
  const bool is_there = compare_cob_id(view, role, pdo, level);
  PdoSettings stated = pdo;
  if (assumed) {
    stated.communication = SetupPolicy::verify;  // So that what is stated is looked at, though no boot reads it.
  }
  if (const std::string why = is_there ? "" : canopen::why_not_without_object(role, pdo); !why.empty()) {
    view.note(Level::error, why);
    return;  // A boot looks no further.
  }
  if (is_there) {
    compare_parameters(view, role, stated, level, remedy_of(pdo.communication, view.drive()));
  }
  compare_mapping(view, role, pdo);
}

}  // namespace

void compare_pdos(DriveView& view) {
  for (const PdoSettings& tpdo : view.drive().node.tpdos) {
    compare_pdo(view, PdoRole::transmit, tpdo);
  }
  for (const PdoSettings& rpdo : view.drive().node.rpdos) {
    compare_pdo(view, PdoRole::receive, rpdo);
  }
}

}  // namespace gateway::compare
