// Any text as a site's file: it is read into a sound model, or into findings that each have a place; never into
// anything else.
#include <cstdint>
#include <string_view>

#include "config/drive/profile.h"
#include "config/load.h"
#include "tests/fuzz/config_rules.h"

namespace {

constexpr std::string_view kProfile = R"(title = "t"
[tpdo1]
map = ["0x2000:01 u16", "0x2000:02 i16"]
event_timer = "100ms"
[rpdo1]
map = ["0x2001:01 u16", "0x2001:02 i16"]
[signals.status_word]
object = "0x2000:01"
type = "u16"
[signals.motor_speed]
object = "0x2000:02"
type = "i16"
[signals.control_command]
object = "0x2001:01"
type = "u16"
access = "write"
[signals.running]
from = "status_word"
mask = 1
[slots.settings]
objects = ["0x2001:02"]
standard = { 1 = "target_velocity" }
[slots.settings.meanings.target_velocity]
type = "i16"
access = "write"
[presets.more]
text = "more"
unconfirmed = "not tried"
[presets.more.signals.fault]
from = "status_word"
mask = 2
)";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  config::ProfileLibrary library({});
  library.add("own", std::string(kProfile));
  const config::LoadOptions options{.file = "gateway.toml", .profile_dirs = {}, .host_name = "host"};
  config::require_sound(config::load_text(text, options, library));
  return 0;
}
