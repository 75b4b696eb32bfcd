#include <algorithm>

#include "config/drive_draft.h"
#include "config/reader.h"
#include "config/text.h"

namespace config {
namespace {

using canopen::Duration;
using canopen::PdoSettings;
using std::chrono::milliseconds;

// CiA 301 table 72: transmission types.
constexpr unsigned kLastSynchronous = 240;
constexpr unsigned kEventDrivenMaker = 254;

/// CiA 301 table 39: identifiers that no PDO may take, and those of the predefined connection set beside its PDOs.
bool is_restricted(std::int64_t cob_id) {
  return cob_id <= 0x180 || (cob_id > 0x580 && cob_id < 0x680) || cob_id >= 0x6E0;
}

canopen::SetupPolicy policy_of(const Node& table, std::string_view key) {
  const auto text = read_text(table, key);
  if (text == "verify") {
    return canopen::SetupPolicy::verify;
  }
  return text == "assume" ? canopen::SetupPolicy::assume : canopen::SetupPolicy::write;
}

class PdoReader {
 public:
  PdoReader(DriveDraft& draft, const Entry& entry, bool is_rpdo)
      : draft_(draft), table_(entry.value), name_(entry.key), is_rpdo_(is_rpdo) {
    pdo_.number = static_cast<std::uint16_t>(parse_integer(std::string_view(entry.key).substr(4)).value_or(1));
  }

  PdoDraft read() {
    read_cob_id();
    pdo_.communication = policy_of(table_, "communication");
    pdo_.mapping_policy = policy_of(table_, "mapping");
    pdo_.transmission_type = read_as<std::uint8_t>(table_, "transmission_type");
    read_times();
    read_map();
    check_type();
    if (!is_rpdo_ && table_.find("unused") != nullptr) {
      error("unused", "unused is for RPDOs; leave signals of a TPDO out with enabled = false");
    }
    return {.settings = pdo_, .table = &table_, .name = name_};
  }

 private:
  void error(std::string_view key, const std::string& text) {
    draft_.error(place_of(table_, key), name_ + ": " + text);
  }

  void read_cob_id() {
    const std::uint8_t node = draft_.drive.node.node;
    if (node == 0) {
      return;
    }
    std::int64_t cob_id = (is_rpdo_ ? 0x200 : 0x180) + 0x100 * (pdo_.number - 1) + node;
    if (const Node* const given = table_.find("cob_id"); given == nullptr) {
      if (pdo_.number > 4) {
        error("cob_id", "cob_id is missing; only PDOs 1 to 4 have a predefined one");
        return;
      }
    } else if (given->kind == NodeKind::integer) {
      cob_id = given->integer;
    } else if (const auto parsed = parse_cob_id(given->text, node); parsed.has_value()) {
      cob_id = *parsed;
    } else {
      return;
    }
    if (cob_id > 0x7FF || is_restricted(cob_id)) {
      error("cob_id", "COB-ID " + to_hex(static_cast<std::uint64_t>(cob_id)) +
                          " is reserved by CiA 301; PDOs have 0x181..0x580 and 0x680..0x6DF");
      return;
    }
    pdo_.cob_id = static_cast<std::uint32_t>(cob_id);
  }

  void read_times() {
    const Duration unit =
        read_text(draft_.merged, "inhibit_unit") == "1ms" ? Duration(milliseconds(1)) : std::chrono::microseconds(100);
    pdo_.inhibit_time = counted("inhibit_time", unit);
    pdo_.event_timer = counted("event_timer", milliseconds(1));
  }

  std::optional<std::uint16_t> counted(std::string_view key, Duration unit) {
    const auto duration = read_duration(table_, key);
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

  void read_map() {
    unsigned bits = 0;
    for (const Node* const item : read_texts(table_, "map")) {
      const auto mapped = parse_mapped(item->text);
      if (!mapped.has_value()) {
        continue;
      }
      const auto length = canopen::bit_length(mapped->second);
      pdo_.mapping.push_back(
          {.object = mapped->first, .type = mapped->second, .bits = static_cast<std::uint8_t>(length)});
      bits += length;
    }
    if (bits > 64) {
      error("map", "map has " + std::to_string(bits) + " bits; a PDO holds 64");
    } else if (read_texts(table_, "map").empty()) {
      error("map", "map is missing; write the objects in their order, such as [\"0x6041 u16\"]");
    }
  }

  void check_type() {
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
      return;
    }
    // Type 0 comes with a SYNC, but only after a change; 254 and 255 are cyclic by their event timer.
    pdo_.period = synchronous ? draft_.bus.sync * type : Duration(milliseconds(pdo_.event_timer.value_or(0)));
  }

  DriveDraft& draft_;
  const Node& table_;
  std::string name_;
  bool is_rpdo_;
  PdoSettings pdo_;
};

/// The objects behind `unused`: names of signals, or objects.
void read_unused(DriveDraft& draft, PdoDraft& pdo) {
  const Node* const signals = read_table(draft.merged, "signals");
  for (const Node* const item : read_texts(*pdo.table, "unused")) {
    const Node* const signal = signals == nullptr ? nullptr : read_table(*signals, item->text);
    const auto object = signal != nullptr ? read_object(*signal, "object") : canopen::parse_object(item->text);
    const auto& mapping = pdo.settings.mapping;
    const bool mapped = object.has_value() && std::any_of(mapping.begin(), mapping.end(),
                                                          [&](const auto& field) { return field.object == *object; });
    if (mapped) {
      pdo.unused.push_back(*object);
    } else {
      draft.error(item->place, pdo.name + ": unused \"" + item->text + "\" is no field of it");
    }
  }
  for (const canopen::ObjectAddress object : draft.unused) {
    pdo.unused.push_back(object);
  }
}

void check_cob_ids(DriveDraft& draft) {
  std::vector<const PdoDraft*> seen;
  for (const auto* const pdos : {&draft.tpdos, &draft.rpdos}) {
    for (const PdoDraft& pdo : *pdos) {
      const auto same = std::find_if(seen.begin(), seen.end(), [&pdo](const PdoDraft* other) {
        return other->settings.cob_id == pdo.settings.cob_id && pdo.settings.cob_id != 0;
      });
      if (same != seen.end()) {
        draft.error(place_of(*pdo.table, "cob_id"),
                    pdo.name + " has the COB-ID " + to_hex(pdo.settings.cob_id) + " of " + (*same)->name);
      }
      seen.push_back(&pdo);
    }
  }
}

}  // namespace

void read_pdos(DriveDraft& draft) {
  for (const Entry& entry : draft.merged.entries) {
    const bool is_rpdo = entry.key.starts_with("rpdo");
    const bool is_pdo = is_rpdo || entry.key.starts_with("tpdo");
    if (!is_pdo || entry.value.kind != NodeKind::table || !read_boolean(entry.value, "enabled").value_or(true)) {
      continue;
    }
    auto& pdos = is_rpdo ? draft.rpdos : draft.tpdos;
    pdos.push_back(PdoReader(draft, entry, is_rpdo).read());
    if (is_rpdo) {
      read_unused(draft, pdos.back());
    }
  }
  const auto by_number = [](const PdoDraft& a, const PdoDraft& b) { return a.settings.number < b.settings.number; };
  std::sort(draft.tpdos.begin(), draft.tpdos.end(), by_number);
  std::sort(draft.rpdos.begin(), draft.rpdos.end(), by_number);
  check_cob_ids(draft);
}

}  // namespace config
