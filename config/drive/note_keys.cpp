#include "config/drive/note_keys.h"

#include "config/schema/form.h"

namespace config {

const SectionOf<LiveKeys>& live_section() {
  using Self = LiveKeys;
  using Field = KeyOf<Self>;
  const auto plain = [](auto member) { return [member](auto& said) -> auto& { return said.check.*member; }; };
  static const SectionOf<Self> section(
      "live",
      {Field("object", &Self::object, object(), "What is read.").required(),
       Field("type", &Self::type, data_type(), "Its type; no reals.").required(),
       Field("name", plain(&LiveCheck::name), text(), "What it is: `\"command source\"`.").required(),
       Field("keypad", plain(&LiveCheck::keypad), text(),
             "What to set at the keypad, in the maker's words: `\"F01.01 = 3 (option card)\"`."),
       Field("mask", &Self::mask, any_integer(1), "Bits that count.").unset("all"),
       Field("equals", &Self::equals, list("list of integers", any_integer()), "Raw values that are right.")
           .unset("none: `limits` is given"),
       Field("limits", plain(&LiveCheck::limits), text(),
             "A signal: what is read is the drive's own limit of it, and its `max` must not be above.")
           .unset("none"),
       Field("scale", plain(&LiveCheck::scale), number(), "Of a limit: raw value x scale, in the signal's unit."),
       Field("signal", plain(&LiveCheck::signal), text(),
             "Looked at only where the drive takes commands and has this signal.")
           .unset("none: always"),
       Field("unconfirmed", plain(&LiveCheck::unconfirmed), text(), "What is not established about it.")});
  return section;
}

const SectionOf<Trial>& trial_section() {
  using Field = KeyOf<Trial>;
  static const SectionOf<Trial> section(
      "trial", {Field("setpoint", &Trial::setpoint, text(), "The signal that gives frequency or speed."),
                Field("value", &Trial::value, number(), "For it, in engineering units."),
                Field("run", &Trial::run, list("list of integers", any_integer()),
                      "Values of `control_command`, one after the other, until the motor runs."),
                Field("reset", &Trial::reset, list("list of integers", any_integer()), "Those that reset a fault.")});
  return section;
}

}  // namespace config
