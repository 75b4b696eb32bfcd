#include "canopen/bus/bit_timing.h"

namespace canopen {

std::string describe(const BitTiming& timing) {
  return std::to_string(timing.bitrate) + " bit/s, sample point " + std::to_string(timing.sample_point / 10) + "." +
         std::to_string(timing.sample_point % 10) + " %, restart-ms " + std::to_string(timing.restart_ms);
}

std::vector<std::string> doubts_about(const BitTiming& timing, std::optional<std::uint32_t> stated) {
  std::vector<std::string> doubts;
  if (stated && *stated != timing.bitrate) {
    doubts.push_back("the interface runs at " + std::to_string(timing.bitrate) + " bit/s, `bitrate` says " +
                     std::to_string(*stated) + ": the interface's is used; put the wrong one right");
  }
  // CiA 301 table 1 wants 87.5 %, and allows 85 to 90 % up to 800 kbit/s.
  if (timing.sample_point != 0 && (timing.sample_point < 700 || timing.sample_point > 900)) {
    doubts.push_back("the sample point of " + std::to_string(timing.sample_point / 10) +
                     " % is far from the 87.5 % of CiA 301: error frames on long lines; `ip link set … type can "
                     "bitrate … sample-point 0.875`");
  }
  if (timing.restart_ms == 0) {
    doubts.emplace_back(
        "restart-ms is 0: after a bus-off the bus stays silent until somebody restarts the interface; `ip link set … "
        "type can restart-ms 100`");
  }
  return doubts;
}

}  // namespace canopen
