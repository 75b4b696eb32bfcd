#include "config/drive/drive_keys.h"
#include "config/text.h"

namespace config {
namespace {

struct Slots {};

const SectionOf<Slots>& slots_section() {
  using Field = KeyOf<Slots>;
  static const SectionOf<Slots> section("slots",
                                        {Field::table("settings", slot_section(), "Behind `settings` of a drive."),
                                         Field::table("returns", slot_section(), "Behind `returns` of a drive.")});
  return section;
}

}  // namespace

const SectionOf<SlotKeys>& slot_section() {
  using Field = KeyOf<SlotKeys>;
  static const SectionOf<SlotKeys> section(
      "slots.settings, slots.returns",
      {Field("objects", &SlotKeys::objects, list("list of strings", object()),
             "The freely assigned objects, from number 1.")
           .filled()
           .required(),
       Field::checked("standard", numbered_texts(1, kLastSlot), "What they mean where the site states nothing."),
       Field("unconfirmed", &SlotKeys::unconfirmed, text(), "Why `check` warns until the site states them."),
       Field::checked(
           "meanings", "tables by name", Layering::by_name, &signal_section(),
           [](const Node& node, const Complaint& complain) {
             check_named(node, signal_section(), is_signal_name, kSignalNameRule, complain);
             for (const Entry& meaning : node.entries) {
               if (const Node* const object = meaning.value.find("object"); object != nullptr) {
                 complain.at(meaning.key).at("object").value(object->place, "is that of its slot; leave it out here");
               }
             }
           },
           "The signals to choose from, without `object`.")
           .required()});
  return section;
}

const SectionOf<ProfileKeys>& profile_section() {
  using Field = KeyOf<ProfileKeys>;
  static const SectionOf<ProfileKeys> section(
      "A profile",
      {Field("title", &ProfileKeys::title, text(), "What drive this is.").required(),
       Field("extends", &ProfileKeys::extends, name(), "A profile that this one is laid over."),
       Field("partial", &ProfileKeys::partial, boolean(), "`true`: only to be extended, no drive by itself."),
       named_key<ProfileKeys>("presets", preset_section(), is_name, "1 to 32 letters, digits, '_' or '-'",
                              "What a drive can switch on by name."),
       Field::table("slots", slots_section(), "Freely assigned objects.")},
      &overlay_section());
  return section;
}

}  // namespace config
