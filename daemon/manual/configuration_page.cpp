#include <algorithm>

#include "config/drive/drive_keys.h"
#include "config/schema/section.h"
#include "config/site/site_keys.h"
#include "daemon/manual/manual.h"
#include "daemon/manual/roff.h"

namespace gateway::manual {
namespace {

void add_key(const config::Key& key, std::string& out) {
  const std::string standard = key.required             ? "; required"
                               : key.standard.empty()   ? ""
                               : key.standard == "none" ? "; none by default"
                                                        : "; default " + key.standard;
  out += tagged(key.name, key.type + standard);
  out += ".br\n" + roff(key.meaning + (key.built ? "" : " Not supported by this version.")) + "\n";
}

void add_section(const config::Section& section, std::vector<const config::Section*>& done, std::string& out) {
  if (std::find(done.begin(), done.end(), &section) != done.end()) {
    return;
  }
  done.push_back(&section);
  out += subheading(section.title());
  if (section.also() != nullptr) {
    out += roff("Also the keys of \"" + section.also()->title() + "\".") + "\n";
  }
  for (const config::Key& key : section.keys()) {
    add_key(key, out);
  }
  for (const config::Key& key : section.keys()) {
    if (key.below != nullptr) {
      add_section(*key.below, done, out);
    }
  }
  if (section.also() != nullptr) {
    add_section(*section.also(), done, out);
  }
}

constexpr std::string_view kSmallest =
    ".PP\n.nf\n.RS\n"
    "[[bus]]\nname = \\(dqcan0\\(dq\n\n"
    "[[drive]]\nname = \\(dqpump1\\(dq\nnode = 5\nprofile = \\(dqveichi\\-ac310\\(dq\n"
    ".RE\n.fi\n";

}  // namespace

std::string configuration_page() {
  std::string out = ".TH GATEWAY.TOML 5 \"\" \"canopen\\-gateway " + roff(GATEWAY_VERSION) + "\"\n";
  out += heading("NAME") + "gateway.toml \\- configuration of canopen\\-gateway\n";
  out += heading("SYNOPSIS") + roff("/etc/canopen-gateway/gateway.toml") + "\n";
  out +=
      heading("DESCRIPTION") +
      roff(
          "A TOML file. `canopen-gateway check` names every mistake in it with line and column, and `canopen-gateway "
          "map` shows what comes of it. The smallest one watches one drive and shows it to nobody:") +
      "\n" + std::string(kSmallest) + ".PP\n" +
      roff(
          "Durations are strings with a unit (us, ms, s, min, h): `\"500ms\"`; sizes likewise (B, kB, MB, GB): "
          "`\"50MB\"`. Names have 1 to 32 letters, digits, `_` or `-`. Objects are hexadecimal strings: "
          "`\"0x2021:02\"`. Modbus, MQTT and HTTP are off until `[modbus]`, `[mqtt]` and `[http]` stand in the file, "
          "and nobody may command a drive until its `writers` names him.") +
      "\n";
  out += heading("KEYS");
  std::vector<const config::Section*> done;
  add_section(config::site_section(), done, out);
  out += heading("KEYS OF A PROFILE") +
         roff(
             "A profile is a TOML file of its own, named by `profile`, in /etc/canopen-gateway/profiles or "
             "/usr/share/canopen-gateway/profiles.") +
         "\n";
  add_section(config::profile_section(), done, out);
  out += heading("SEE ALSO") + roff("canopen-gateway(1), and docs/CONFIGURATION.md in /usr/share/doc/canopen-gateway") +
         "\n";
  return out;
}

}  // namespace gateway::manual
