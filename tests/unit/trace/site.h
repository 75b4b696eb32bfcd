#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "bridges/trace/candump.h"
#include "bridges/trace/decoder.h"
#include "bridges/trace/line.h"
#include "bridges/trace/words.h"
#include "config/load.h"

namespace trace::test {

/// Drives of the profiles that are shipped, with the node ids of tests/golden.
inline config::Model site() {
  const std::string text = R"([[bus]]
name = "can0"
[[bus]]
name = "can1"
[[drive]]
name = "fan1"
bus = "can0"
node = 2
profile = "veichi-ac300"
presets = ["veichi-command-codes"]
[[drive]]
name = "hoist1"
bus = "can0"
node = 3
profile = "invt-goodrive600"
settings = { 1 = "unused", 2 = "frequency_command", 3 = "unused" }
returns = { 1 = "output_frequency", 2 = "set_frequency", 3 = "dc_bus_voltage" }
[[drive]]
name = "mixer1"
bus = "can0"
node = 4
profile = "vacon-opte6"
[[drive]]
name = "pump1"
bus = "can0"
node = 5
profile = "veichi-ac310"
[[drive]]
name = "winder1"
bus = "can1"
node = 6
profile = "cia402-velocity"
)";
  const config::LoadOptions options{
      .file = "site.toml", .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = "host"};
  config::Loaded loaded = config::load_text(text, options);
  for (const config::Finding& finding : loaded.findings) {
    EXPECT_NE(finding.level, config::Finding::Level::error) << to_string(finding);
  }
  return loaded.model ? *loaded.model : config::Model{};
}

/// The frames of one bus in words, one after the other.
class Listener {
 public:
  explicit Listener(std::size_t bus = 0) : decoder_(model_, bus) {}

  /// A frame as candump writes it: `185#0102`.
  Entry hear(std::string_view frame, canopen::FrameOrigin origin = canopen::FrameOrigin::others) {
    const auto read = parse_candump_line("(1767323045.678123) can0 " + std::string(frame));
    const auto* const logged = std::get_if<LoggedFrame>(&read);
    EXPECT_NE(logged, nullptr) << frame;
    return logged == nullptr ? Entry{} : decoder_.decode(logged->frame, logged->at, origin);
  }
  /// `pump1 TPDO1: output_frequency 49.97 Hz`
  std::string words(std::string_view frame) {
    const Line line = line_of(model_, hear(frame));
    return (line.owner.empty() ? "" : line.owner + " ") + line.name + (line.text.empty() ? "" : ": " + line.text);
  }
  [[nodiscard]] const config::Model& model() const noexcept { return model_; }
  [[nodiscard]] Decoder& decoder() noexcept { return decoder_; }

 private:
  config::Model model_ = site();
  Decoder decoder_;
};

}  // namespace trace::test
