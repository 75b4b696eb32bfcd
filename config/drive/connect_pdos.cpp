#include <algorithm>

#include "config/drive/builder.h"
#include "config/toml/document.h"

namespace config {
namespace {

using canopen::FieldUse;
using canopen::MappedObject;
using canopen::ObjectAddress;

MappedObject* field_of(PdoDraft& pdo, ObjectAddress object) {
  auto& mapping = pdo.settings.mapping;
  const auto found =
      std::find_if(mapping.begin(), mapping.end(), [object](const MappedObject& m) { return m.object == object; });
  return found == mapping.end() ? nullptr : &*found;
}

PdoDraft* pdo_with(std::vector<PdoDraft>& pdos, ObjectAddress object) {
  const auto found =
      std::find_if(pdos.begin(), pdos.end(), [object](PdoDraft& pdo) { return field_of(pdo, object) != nullptr; });
  return found == pdos.end() ? nullptr : &*found;
}

bool is_unused(const PdoDraft& pdo, ObjectAddress object) {
  return std::find(pdo.unused.begin(), pdo.unused.end(), object) != pdo.unused.end();
}

void error_of(const DriveDraft& draft, const SignalDraft& signal, std::string_view key, const std::string& text) {
  draft.error(place_of(*signal.said, key), "signal \"" + signal.signal.name + "\" " + text);
}

/// The PDO that serves a signal: the one `source` names, else the first that maps its object the right way round.
PdoDraft* choose(DriveDraft& draft, const SignalDraft& signal) {
  const auto& stated = signal.said->keys.source;
  const ObjectAddress object = signal.signal.object;
  if (stated == "sdo") {
    return nullptr;
  }
  if (!stated.has_value()) {
    if (signal.signal.access == Access::write) {
      return pdo_with(draft.rpdos, object);
    }
    if (signal.signal.access == Access::read_write && pdo_with(draft.rpdos, object) != nullptr) {
      error_of(draft, signal, "access",
               "is mapped in " + pdo_with(draft.rpdos, object)->said->name +
                   ", which cannot be read back; write access = \"write\", or source = \"sdo\"");
      return nullptr;
    }
    return pdo_with(draft.tpdos, object);
  }
  for (auto* const pdos : {&draft.tpdos, &draft.rpdos}) {
    for (PdoDraft& pdo : *pdos) {
      if (pdo.said->name == *stated && field_of(pdo, object) != nullptr) {
        return &pdo;
      }
    }
  }
  error_of(draft, signal, "source",
           "has the source \"" + *stated + "\", which does not map " + canopen::to_string(object) +
               "; leave source out, or say \"sdo\"");
  return nullptr;
}

void connect(DriveDraft& draft, SignalDraft& draft_signal) {
  Signal& signal = draft_signal.signal;
  PdoDraft* const pdo = choose(draft, draft_signal);
  if (signal.pdo_only && (pdo == nullptr || !pdo->said->name.starts_with("rpdo"))) {
    draft.error(
        place_of(*draft_signal.said, "pdo_only", {"source", "access"}),
        "signal \"" + signal.name +
            "\" is pdo_only, but goes out in no RPDO, so nothing could write it; leave pdo_only out, or map it");
    return;
  }
  if (pdo == nullptr) {
    return;
  }
  const bool is_rpdo = pdo->said->name.starts_with("rpdo");
  if (is_rpdo != (signal.access == Access::write)) {
    error_of(draft, draft_signal, "access",
             is_rpdo ? "goes out in " + pdo->said->name + ", so access must be \"write\""
                     : "comes in " + pdo->said->name + ", so access must be \"read\" or \"read-write\"");
    return;
  }
  MappedObject& field = *field_of(*pdo, signal.object);
  if (field.bits != canopen::bit_length(signal.type)) {
    // Where only one of both stands in the site's file, it is the site's that does not fit.
    const Place place = in_the_site(place_of(*draft_signal.said, "type"), place_of(*pdo->said, "map"));
    draft.error(place, "signal \"" + signal.name + "\" is " + std::string(canopen::name_of(signal.type)) + ", but " +
                           pdo->said->name + " maps its object with " + std::to_string(field.bits) +
                           " bits; they must agree");
    return;
  }
  // A site may know better whether sixteen bits have a sign; the length is the mapping's.
  field.type = signal.type;
  signal.unconfirmed |= pdo->said->keys.unconfirmed;
  signal.source = {.kind = is_rpdo ? SourceKind::rpdo : SourceKind::tpdo, .number = pdo->settings.number};
}

bool serves(const DriveDraft& draft, SourceKind kind, std::uint16_t number) {
  return std::any_of(draft.signals.begin(), draft.signals.end(), [&](const SignalDraft& s) {
    return !s.derived() && s.signal.source.kind == kind && s.signal.source.number == number;
  });
}

FieldUse use_of(const DriveDraft& draft, const PdoDraft& pdo, ObjectAddress object) {
  if (is_dummy(object) || is_unused(pdo, object)) {
    return FieldUse::unused;
  }
  const bool commanded = std::any_of(draft.signals.begin(), draft.signals.end(), [&](const SignalDraft& s) {
    return s.signal.source.kind == SourceKind::rpdo && s.signal.source.number == pdo.settings.number &&
           s.signal.object == object;
  });
  return commanded ? FieldUse::commanded : FieldUse::unnamed;
}

void check_writable_once(const DriveDraft& draft) {
  for (std::size_t i = 0; i < draft.signals.size(); ++i) {
    const SignalDraft& signal = draft.signals[i];
    const auto same =
        std::find_if(draft.signals.begin(), draft.signals.begin() + static_cast<std::ptrdiff_t>(i),
                     [&signal](const SignalDraft& other) {
                       return writable(other.signal.access) && other.signal.object == signal.signal.object;
                     });
    if (!signal.derived() && writable(signal.signal.access) &&
        same != draft.signals.begin() + static_cast<std::ptrdiff_t>(i)) {
      error_of(draft, signal, "object",
               "writes " + canopen::to_string(signal.signal.object) + ", as \"" + same->signal.name +
                   "\" does; leave one of them out");
    }
  }
}

}  // namespace

void connect_pdos(DriveDraft& draft) {
  for (PdoDraft& pdo : draft.rpdos) {
    // What goes out as 0 with every RPDO must not be commanded by SDO beside it.
    std::erase_if(draft.signals, [&pdo](const SignalDraft& s) {
      return !s.derived() && writable(s.signal.access) && is_unused(pdo, s.signal.object) &&
             field_of(pdo, s.signal.object) != nullptr;
    });
  }
  for (SignalDraft& signal : draft.signals) {
    if (!signal.derived()) {
      connect(draft, signal);
    }
  }
  check_writable_once(draft);
  for (const PdoDraft& pdo : draft.tpdos) {
    if (serves(draft, SourceKind::tpdo, pdo.settings.number)) {
      draft.drive.node.tpdos.push_back(pdo.settings);
    }
  }
  for (PdoDraft& pdo : draft.rpdos) {
    if (!serves(draft, SourceKind::rpdo, pdo.settings.number)) {
      continue;
    }
    for (MappedObject& field : pdo.settings.mapping) {
      field.use = use_of(draft, pdo, field.object);
    }
    draft.drive.node.rpdos.push_back(pdo.settings);
  }
}

}  // namespace config
