#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "config/site/site.h"
#include "config/site/site_keys.h"
#include "config/text.h"
#include "config/toml/document.h"

namespace config {
namespace {

// A line of candump and the bits on the wire of a frame of eight bytes.
constexpr double kBytesOfALine = 46;
constexpr double kBitsOfAFrame = 111;

/// What a record of a full bus takes at most, in bytes; without a bit rate nobody knows.
double longest_log(const Recorder& recorder, const std::vector<Bus>& buses) {
  double bitrate = 0;
  for (const Bus& bus : buses) {
    bitrate = std::max<double>(bitrate, bus.bitrate.value_or(0));
  }
  return std::chrono::duration<double>(recorder.before + recorder.after).count() * bitrate / kBitsOfAFrame *
         kBytesOfALine;
}

}  // namespace

std::optional<Recorder> read_recorder(const Node& root, const Gateway& gateway, const std::vector<Bus>& buses,
                                      Report& report) {
  const Node* const table = read_table(root, "recorder");
  if (table == nullptr) {
    return std::nullopt;
  }
  const Recorder recorder = recorder_section().read(*table);
  if (gateway.state_dir.empty()) {
    report.warning(table->place,
                   "[recorder] has nowhere to keep its records, since gateway.state_dir is empty; nothing is recorded");
  }
  const double longest = longest_log(recorder, buses);
  if (longest > static_cast<double>(recorder.keep) / 2) {
    report.warning(place_of(*table, "keep"),
                   "recorder.keep is too little for a full bus: a log takes half of it at most, and is cut there, but "
                   "may have " +
                       to_text(std::ceil(longest / 100'000) / 10) + " MB");
  }
  return recorder;
}

}  // namespace config
