#include <algorithm>
#include <map>
#include <string_view>

#include "config/drive/builder.h"
#include "config/schema/complaint.h"
#include "config/schema/merge.h"
#include "config/schema/nearest.h"
#include "config/text.h"
#include "config/toml/document.h"

namespace config {
namespace {

constexpr std::string_view kUnused = "unused";

/// What profiles, presets and drives have in common, out of a table that says more.
Node overlay_of(const Node& table) {
  Node overlay;
  overlay.place = table.place;
  for (const Entry& entry : table.entries) {
    if (overlay_section().find(entry.key) != nullptr) {
      overlay.entries.push_back(entry);
    }
  }
  return overlay;
}

/// `nearest is "x"`, or all there are.
std::string remedy_of(std::string_view name, const Node& table) {
  std::vector<std::string_view> names;
  for (const Entry& entry : table.entries) {
    names.emplace_back(entry.key);
  }
  return nearest_or_all(name, names);
}

void lay_presets(DriveDraft& draft, const Profile& profile) {
  const Node* const presets = read_table(profile.table, "presets");
  std::vector<std::string> used;
  for (const Node* const asked : read_texts(draft.site, "presets")) {
    const Node* const preset = presets == nullptr ? nullptr : read_table(*presets, asked->text);
    if (preset == nullptr) {
      draft.error(asked->place, presets == nullptr ? "profile \"" + profile.name + "\" has no presets"
                                                   : "preset " + in_quotes(asked->text) + " is not known; " +
                                                         remedy_of(asked->text, *presets));
      continue;
    }
    if (std::find(used.begin(), used.end(), asked->text) != used.end()) {
      draft.error(asked->place, "preset \"" + asked->text + "\" stands there twice");
      continue;
    }
    used.push_back(asked->text);
    lay_over(draft.merged, overlay_of(*preset), overlay_section());
    if (const auto reason = preset_section().read(*preset).unconfirmed; reason.has_value()) {
      draft.warning(asked->place, "preset \"" + asked->text + "\" is unconfirmed: " + *reason);
      if (const Node* const signals = read_table(*preset, "signals"); signals != nullptr) {
        for (const Entry& signal : signals->entries) {
          draft.told_unconfirmed.insert(signal.key);
        }
      }
    }
  }
}

/// Objects whose meaning is chosen in the drive: `settings` and `returns` of a Goodrive.
class Assigner {
 public:
  Assigner(DriveDraft& draft, const Profile& profile, std::string_view slot_name)
      : draft_(draft), profile_(profile), slot_name_(slot_name) {}

  void run() {
    const Node* const stated = draft_.site.find(slot_name_);
    const Node* const slots = read_table(profile_.table, "slots");
    const Node* const slot = slots == nullptr ? nullptr : read_table(*slots, slot_name_);
    if (slot == nullptr) {
      if (stated != nullptr) {
        draft_.error(place_of(draft_.site, slot_name_),
                     "profile \"" + profile_.name + "\" has no " + std::string(slot_name_));
      }
      return;
    }
    if (stated != nullptr && stated->kind != NodeKind::table) {
      return;  // it has its finding
    }
    const SlotKeys keys = slot_section().read(*slot);
    objects_ = keys.objects;
    meanings_ = read_table(*slot, "meanings");
    if (objects_.empty() || meanings_ == nullptr) {
      return;  // the profile has its finding
    }
    if (const Node* const chosen = stated != nullptr ? stated : read_table(*slot, "standard"); chosen != nullptr) {
      for (const auto& [number, entry] : read_numbered(*chosen)) {
        assign(number, *entry, stated == nullptr);
      }
    }
    if (stated == nullptr && keys.unconfirmed.has_value()) {
      draft_.warning(draft_.site.place, std::string(slot_name_) + " are not stated: " + *keys.unconfirmed);
    }
  }

 private:
  void assign(std::int64_t number, const Entry& entry, bool unconfirmed) {
    if (number < 1 || number > kLastSlot || entry.value.kind != NodeKind::text) {
      return;  // it has its finding
    }
    if (number > static_cast<std::int64_t>(objects_.size())) {
      draft_.error(entry.key_place, std::string(slot_name_) + " has no number " + std::to_string(number) + "; 1.." +
                                        std::to_string(objects_.size()) + " are there");
      return;
    }
    const canopen::ObjectAddress object = objects_[static_cast<std::size_t>(number - 1)];
    const std::string& meaning = entry.value.text;
    if (meaning == kUnused) {
      draft_.unused.push_back(object);
      return;
    }
    const Node* const signal = read_table(*meanings_, meaning);
    if (signal == nullptr) {
      draft_.error(entry.value.place, std::string(slot_name_) + " " + std::to_string(number) + " = " +
                                          in_quotes(meaning) + " is not known; " + remedy_of(meaning, *meanings_));
      return;
    }
    if (!given_.insert({meaning, number}).second) {
      draft_.error(entry.value.place, std::string(slot_name_) + " " + std::to_string(given_[meaning]) + " and " +
                                          std::to_string(number) + " both are \"" + meaning + "\"");
      return;
    }
    add_signal(meaning, *signal, object, entry.value.place, unconfirmed);
  }

  void add_signal(const std::string& name, Node signal, canopen::ObjectAddress object, Place place, bool unconfirmed) {
    const auto put = [place](Node& table, std::string_view key, Node value) {
      std::erase_if(table.entries, [key](const Entry& entry) { return entry.key == key; });
      value.place = place;
      table.entries.push_back({.key = std::string(key), .key_place = place, .value = std::move(value)});
    };
    Node text;
    text.kind = NodeKind::text;
    text.text = canopen::to_string(object);
    put(signal, "object", std::move(text));
    if (unconfirmed) {
      Node yes;
      yes.kind = NodeKind::boolean;
      yes.boolean = true;
      put(signal, "unconfirmed", std::move(yes));
      draft_.told_unconfirmed.insert(name);
    }
    Node layer;
    put(layer, name, std::move(signal));
    Node signals;
    put(signals, "signals", std::move(layer));
    lay_over(draft_.merged, signals, overlay_section());
  }

  DriveDraft& draft_;
  const Profile& profile_;
  std::string_view slot_name_;
  std::vector<canopen::ObjectAddress> objects_;
  const Node* meanings_ = nullptr;
  std::map<std::string, std::int64_t> given_;
};

}  // namespace

void compose(DriveDraft& draft, const Profile& profile) {
  draft.merged = overlay_of(profile.table);
  lay_presets(draft, profile);
  Assigner(draft, profile, "settings").run();
  Assigner(draft, profile, "returns").run();
  lay_over(draft.merged, overlay_of(draft.site), overlay_section());
  draft.merged.place = draft.site.place;
}

}  // namespace config
