#include <algorithm>
#include <map>
#include <string_view>

#include "config/drive_draft.h"
#include "config/merge.h"
#include "config/nearest.h"
#include "config/reader.h"
#include "config/schema.h"
#include "config/text.h"

namespace config {
namespace {

constexpr std::string_view kUnused = "unused";

/// What profiles, presets and drives have in common, out of a table that says more.
Node overlay_of(const Node& table) {
  Node overlay;
  overlay.place = table.place;
  for (const Entry& entry : table.entries) {
    if (find_key(kOverlaySection, entry.key) != nullptr) {
      overlay.entries.push_back(entry);
    }
  }
  return overlay;
}

std::string nearest_key(std::string_view name, const Node& table) {
  std::vector<std::string_view> names;
  for (const Entry& entry : table.entries) {
    names.emplace_back(entry.key);
  }
  return std::string(nearest(name, names));
}

void lay_presets(DriveDraft& draft, const Profile& profile) {
  const Node* const presets = read_table(profile.table, "presets");
  std::vector<std::string> used;
  for (const Node* const asked : read_texts(draft.site, "presets")) {
    const Node* const preset = presets == nullptr ? nullptr : read_table(*presets, asked->text);
    if (preset == nullptr) {
      draft.error(asked->place, presets == nullptr ? "profile \"" + profile.name + "\" has no presets"
                                                   : "preset \"" + asked->text + "\" is not known; nearest is \"" +
                                                         nearest_key(asked->text, *presets) + "\"");
      continue;
    }
    if (std::find(used.begin(), used.end(), asked->text) != used.end()) {
      draft.error(asked->place, "preset \"" + asked->text + "\" stands there twice");
      continue;
    }
    used.push_back(asked->text);
    lay_over(draft.merged, overlay_of(*preset));
    if (const auto reason = read_text(*preset, "unconfirmed"); reason.has_value()) {
      draft.warning(asked->place, "preset \"" + asked->text + "\" is unconfirmed: " + *reason);
    }
  }
}

Node text_node(std::string text, Place place) {
  Node node;
  node.kind = NodeKind::text;
  node.text = std::move(text);
  node.place = place;
  return node;
}

void set_entry(Node& table, std::string_view key, Node value) {
  if (Node* const known = table.find(key); known != nullptr) {
    *known = std::move(value);
  } else {
    const Place place = value.place;
    table.entries.push_back({.key = std::string(key), .key_place = place, .value = std::move(value)});
  }
}

/// Objects whose meaning is chosen in the drive: `settings` and `returns` of a Goodrive.
class Assigner {
 public:
  Assigner(DriveDraft& draft, const Profile& profile, std::string_view slot_name)
      : draft_(draft), profile_(profile), slot_name_(slot_name) {}

  void run() {
    const Node* const stated = read_table(draft_.site, slot_name_);
    const Node* const slots = read_table(profile_.table, "slots");
    const Node* const slot = slots == nullptr ? nullptr : read_table(*slots, slot_name_);
    if (slot == nullptr) {
      if (stated != nullptr) {
        draft_.error(place_of(draft_.site, slot_name_),
                     "profile \"" + profile_.name + "\" has no " + std::string(slot_name_));
      }
      return;
    }
    objects_ = read_texts(*slot, "objects");
    meanings_ = read_table(*slot, "meanings");
    const auto chosen = stated != nullptr ? read_numbered(draft_.site, slot_name_) : read_numbered(*slot, "standard");
    for (const auto& [number, entry] : chosen) {
      assign(number, *entry, stated == nullptr);
    }
    if (const auto reason = read_text(*slot, "unconfirmed"); stated == nullptr && reason.has_value()) {
      draft_.warning(draft_.site.place, std::string(slot_name_) + " are not stated: " + *reason);
    }
  }

 private:
  void assign(std::int64_t number, const Entry& entry, bool unconfirmed) {
    if (number < 1 || number > static_cast<std::int64_t>(objects_.size())) {
      draft_.error(entry.key_place, std::string(slot_name_) + " has no number " + std::to_string(number) + "; 1.." +
                                        std::to_string(objects_.size()) + " are there");
      return;
    }
    const Node& object = *objects_[static_cast<std::size_t>(number - 1)];
    const std::string& meaning = entry.value.text;
    if (meaning == kUnused) {
      if (const auto address = canopen::parse_object(object.text); address.has_value()) {
        draft_.unused.push_back(*address);
      }
      return;
    }
    const Node* const signal = meanings_ == nullptr ? nullptr : read_table(*meanings_, meaning);
    if (signal == nullptr) {
      draft_.error(entry.value.place, std::string(slot_name_) + " " + std::to_string(number) + " = \"" + meaning +
                                          "\" is not known; nearest is \"" +
                                          (meanings_ == nullptr ? "unused" : nearest_key(meaning, *meanings_)) + "\"");
      return;
    }
    if (!given_.insert({meaning, number}).second) {
      draft_.error(entry.value.place, std::string(slot_name_) + " " + std::to_string(given_[meaning]) + " and " +
                                          std::to_string(number) + " both are \"" + meaning + "\"");
      return;
    }
    add_signal(meaning, *signal, object, entry.value.place, unconfirmed);
  }

  void add_signal(const std::string& name, Node signal, const Node& object, Place place, bool unconfirmed) {
    set_entry(signal, "object", text_node(object.text, place));
    if (unconfirmed) {
      Node yes;
      yes.kind = NodeKind::boolean;
      yes.boolean = true;
      yes.place = place;
      set_entry(signal, "unconfirmed", std::move(yes));
    }
    if (read_table(draft_.merged, "signals") == nullptr) {
      Node empty;
      empty.place = place;
      set_entry(draft_.merged, "signals", std::move(empty));
    }
    Node layer;
    layer.entries.push_back({.key = name, .key_place = place, .value = std::move(signal)});
    lay_over(*draft_.merged.find("signals"), layer);
  }

  DriveDraft& draft_;
  const Profile& profile_;
  std::string_view slot_name_;
  std::vector<const Node*> objects_;
  const Node* meanings_ = nullptr;
  std::map<std::string, std::int64_t> given_;
};

}  // namespace

void compose(DriveDraft& draft, const Profile& profile) {
  draft.merged = overlay_of(profile.table);
  lay_presets(draft, profile);
  Assigner(draft, profile, "settings").run();
  Assigner(draft, profile, "returns").run();
  lay_over(draft.merged, overlay_of(draft.site));
  draft.merged.place = draft.site.place;
}

}  // namespace config
