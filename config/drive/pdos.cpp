#include <algorithm>

#include "config/drive/builder.h"
#include "config/schema/complaint.h"
#include "config/text.h"
#include "config/toml/document.h"

namespace config {
namespace {

using canopen::Duration;
using canopen::ObjectAddress;
using canopen::PdoSettings;
using std::chrono::milliseconds;

// CiA 301 table 72: transmission types.
constexpr unsigned kLastSynchronous = 240;
constexpr unsigned kEventDrivenMaker = 254;

/// CiA 301 table 39: identifiers that no PDO may take, and those of the predefined connection set beside its PDOs.
bool is_restricted(std::int64_t cob_id) {
  return cob_id <= 0x180 || (cob_id > 0x580 && cob_id < 0x680) || cob_id >= 0x6E0;
}

class PdoTaker {
 public:
  PdoTaker(DriveDraft& draft, const Said<PdoKeys>& said)
      : draft_(draft),
        said_(said),
        keys_(said.keys),
        is_rpdo_(said.name.starts_with("rpdo")),
        pdo_(said.keys.settings) {
    pdo_.number = static_cast<std::uint16_t>(parse_integer(std::string_view(said.name).substr(4)).value_or(1));
  }

  PdoDraft take() {
    take_cob_id();
    pdo_.inhibit_time = counted("inhibit_time", keys_.inhibit_time, draft_.said.inhibit_unit);
    pdo_.inhibit_unit = draft_.said.inhibit_unit;
    pdo_.event_timer = counted("event_timer", keys_.event_timer, milliseconds(1));
    take_map();
    take_type();
    for (const auto* const key : {"unused", "supervised"}) {
      if (!is_rpdo_ && said_.table->find(key) != nullptr) {
        error(key, std::string(key) + " is for RPDOs" +
                       (key == std::string_view("unused") ? "; leave signals of a TPDO out with enabled = false" : ""));
      }
    }
    return {.said = &said_, .settings = pdo_};
  }

 private:
  void error(std::string_view key, const std::string& text) {
    draft_.error(place_of(said_, key), said_.name + ": " + text);
  }

  void take_cob_id() {
    const std::uint8_t node = draft_.drive.node.node;
    if (node == 0) {
      return;
    }
    std::int64_t cob_id = (is_rpdo_ ? 0x200 : 0x180) + 0x100 * (pdo_.number - 1) + node;
    if (keys_.cob_id.has_value()) {
      cob_id = keys_.cob_id->base + (keys_.cob_id->plus_node ? node : 0);
    } else if (said_.table->find("cob_id") != nullptr) {
      return;
    } else if (pdo_.number > 4) {
      error("cob_id", "cob_id is missing; only PDOs 1 to 4 have a predefined one");
      return;
    }
    if (cob_id > 0x7FF || is_restricted(cob_id)) {
      error("cob_id", "COB-ID " + to_hex(static_cast<std::uint64_t>(cob_id)) +
                          " is reserved by CiA 301; PDOs have 0x181..0x580 and 0x680..0x6DF");
      return;
    }
    pdo_.cob_id = static_cast<std::uint32_t>(cob_id);
  }

  std::optional<std::uint16_t> counted(std::string_view key, std::optional<Duration> duration, Duration unit) {
    if (!duration.has_value()) {
      return std::nullopt;
    }
    const auto count = *duration / unit;
    if (*duration % unit != Duration::zero() || count > 0xFFFF) {
      error(key, std::string(key) + " \"" + to_text(*duration) + "\" must be a multiple of " + to_text(unit) +
                     " and at most " + to_text(unit * 0xFFFF));
      return std::nullopt;
    }
    return static_cast<std::uint16_t>(count);
  }

  void take_map() {
    unsigned bits = 0;
    for (const auto& [object, type] : keys_.map) {
      const bool twice = std::any_of(pdo_.mapping.begin(), pdo_.mapping.end(),
                                     [&](const auto& before) { return before.object == object; });
      if (twice && !is_dummy(object)) {
        error("map", "map names " + canopen::to_string(object) + " twice");
      }
      const auto length = canopen::bit_length(type);
      pdo_.mapping.push_back({.object = object, .type = type, .bits = static_cast<std::uint8_t>(length)});
      bits += length;
    }
    const Node* const map = said_.table->find("map");
    if (bits > 64) {
      error("map", "map has " + std::to_string(bits) + " bits; a PDO holds 64");
    } else if (map == nullptr || (map->kind == NodeKind::list && map->items.empty())) {
      error("map", "map is missing; write the objects in their order, such as [\"0x6041 u16\"]");
    }
  }

  void take_type() {
    const unsigned type = pdo_.transmission_type.value_or(kEventDrivenMaker);
    if (type > kLastSynchronous && type < kEventDrivenMaker) {
      error("transmission_type",
            "transmission type " + std::to_string(type) + " is reserved or on request only; use 0..240, 254 or 255");
      return;
    }
    const bool synchronous = type <= kLastSynchronous;
    if (synchronous && draft_.bus.sync == Duration::zero()) {
      error("transmission_type",
            "transmission type " + std::to_string(type) + " needs SYNC; set sync of bus \"" + draft_.bus.name + "\"");
    }
    if (is_rpdo_) {
      take_event_timer();
      return;
    }
    // Type 0 comes with a SYNC, but only after a change; 254 and 255 are cyclic by their event timer.
    pdo_.period = synchronous ? draft_.bus.sync * type : Duration(milliseconds(pdo_.event_timer.value_or(0)));
    pdo_.shortest_period = keys_.inhibit_time.value_or(Duration::zero());
    if (!synchronous && keys_.inhibit_time > keys_.event_timer && pdo_.event_timer.value_or(0) != 0) {
      draft_.warning(place_of(said_, "inhibit_time", {"event_timer"}),
                     said_.name + ": inhibit_time \"" + to_text(*keys_.inhibit_time) + "\" is above event_timer \"" +
                         to_text(*keys_.event_timer) + "\" and holds it back; make it shorter");
    }
  }

  /// An RPDO is repeated three times per event timer, but not faster than every 5 ms.
  void take_event_timer() {
    constexpr std::uint16_t kTooShort = 5;
    constexpr std::uint16_t kShort = 10;
    const std::uint16_t timer = pdo_.event_timer.value_or(0);
    // Somebody counts on it: the site, which wrote it, or the profile, which says that the drive has it.
    const bool of_the_site = place_of(said_, "event_timer").file == 0;
    pdo_.event_timer_required = timer != 0 && (of_the_site || keys_.supervised);
    if (timer != 0 && timer <= kTooShort) {
      error("event_timer", "event_timer \"" + to_text(*keys_.event_timer) +
                               "\" is shorter than an RPDO can be repeated (5 ms), so the drive would trip");
    } else if (timer != 0 && timer < kShort) {
      draft_.warning(place_of(said_, "event_timer"), said_.name + ": event_timer \"" + to_text(*keys_.event_timer) +
                                                         "\" is below twice the shortest repetition (5 ms), so one " +
                                                         "late frame trips the drive");
    }
  }

  DriveDraft& draft_;
  const Said<PdoKeys>& said_;
  const PdoKeys& keys_;
  bool is_rpdo_;
  PdoSettings pdo_;
};

/// `its fields are control_command, 0x6042:00`
std::string fields_of(const DriveDraft& draft, const PdoDraft& pdo) {
  std::string all;
  for (const canopen::MappedObject& field : pdo.settings.mapping) {
    const auto& signals = draft.said.signals;
    const auto signal =
        std::find_if(signals.begin(), signals.end(), [&field](const auto& s) { return s.keys.object == field.object; });
    all += (all.empty() ? "its fields are " : ", ") +
           (signal != signals.end() ? signal->name : canopen::to_string(field.object));
  }
  return all;
}

/// The objects behind `unused`: names of signals, or objects.
void take_unused(DriveDraft& draft, PdoDraft& pdo) {
  for (const Node* const item : read_texts(*pdo.said->table, "unused")) {
    const auto& signals = draft.said.signals;
    const auto signal =
        std::find_if(signals.begin(), signals.end(), [item](const auto& s) { return s.name == item->text; });
    const auto object = signal != signals.end() ? signal->keys.object : parse_stated_object(item->text);
    const auto& mapping = pdo.settings.mapping;
    const bool mapped = object.has_value() && std::any_of(mapping.begin(), mapping.end(),
                                                          [&](const auto& field) { return field.object == *object; });
    if (mapped) {
      pdo.unused.push_back(*object);
    } else {
      draft.error(item->place, pdo.said->name + ": unused " + in_quotes(item->text) + " is no field of it; " +
                                   fields_of(draft, pdo));
    }
  }
  pdo.unused.insert(pdo.unused.end(), draft.unused.begin(), draft.unused.end());
}

void check_cob_ids(const DriveDraft& draft) {
  std::vector<const PdoDraft*> seen;
  for (const auto* const pdos : {&draft.tpdos, &draft.rpdos}) {
    for (const PdoDraft& pdo : *pdos) {
      const auto same = std::find_if(seen.begin(), seen.end(), [&pdo](const PdoDraft* other) {
        return other->settings.cob_id == pdo.settings.cob_id && pdo.settings.cob_id != 0;
      });
      if (same != seen.end()) {
        draft.error(in_the_site(place_of(*pdo.said, "cob_id"), place_of(*(*same)->said, "cob_id")),
                    pdo.said->name + " has the COB-ID " + to_hex(pdo.settings.cob_id) + " of " + (*same)->said->name +
                        "; give one of them another cob_id");
      }
      seen.push_back(&pdo);
    }
  }
}

}  // namespace

void take_pdos(DriveDraft& draft) {
  const auto by_number = [](const PdoDraft& a, const PdoDraft& b) { return a.settings.number < b.settings.number; };
  const auto take = [&](const std::vector<Said<PdoKeys>>& all, std::vector<PdoDraft>& pdos) {
    for (const Said<PdoKeys>& said : all) {
      if (said.keys.enabled) {
        pdos.push_back(PdoTaker(draft, said).take());
        if (&pdos == &draft.rpdos) {
          take_unused(draft, pdos.back());
        }
      } else if (said.table->find("map") == nullptr) {
        // A misspelt one would go on.
        draft.error(said.place, said.name + " is not in profile \"" + draft.drive.profile +
                                    "\", so it needs no switching off; leave it out");
      }
    }
    std::sort(pdos.begin(), pdos.end(), by_number);
  };
  take(draft.said.tpdos, draft.tpdos);
  take(draft.said.rpdos, draft.rpdos);
  check_cob_ids(draft);
}

}  // namespace config
