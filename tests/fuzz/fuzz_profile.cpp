// Any text as a profile, used by a site that asks for all a profile can have.
#include <cstdint>
#include <string_view>

#include "config/drive/profile.h"
#include "config/load.h"
#include "tests/fuzz/config_rules.h"

namespace {

constexpr std::string_view kSite = R"([[bus]]
name = "can0"
sync = "20ms"
[[drive]]
name = "plain"
node = 5
profile = "own"
[drive.commands]
writers = ["modbus"]
[[drive]]
name = "stated"
node = 6
profile = "own"
presets = ["a", "b"]
settings = { 1 = "x", 2 = "unused" }
returns = { 1 = "y" }
[drive.signals.status_word]
deadband = 1
)";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  config::ProfileLibrary library({});
  library.add("own", text);
  library.add("base", "title = \"base\"\n[signals.status_word]\nobject = \"0x6041\"\ntype = \"u16\"\n");
  const config::LoadOptions options{.file = "gateway.toml", .profile_dirs = {}, .host_name = "host"};
  config::require_sound(config::load_text(kSite, options, library));
  return 0;
}
