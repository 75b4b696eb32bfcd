#include "daemon/program_health.h"

#include <unistd.h>

#include <chrono>
#include <fstream>
#include <utility>

#include "daemon/log.h"

namespace gateway {
namespace {

// The second number of statm, in pages (proc(5)).
std::uint64_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t all = 0;
  std::uint64_t resident = 0;
  statm >> all >> resident;
  return statm ? resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace

process::ProgramHealth program_health(canopen::TimePoint started, std::string journal) {
  return {.uptime = canopen::Clock::now() - started,
          .memory = resident_bytes(),
          .log_lost = Log::dropped(),
          .journal = std::move(journal),
          .clock_set = !is_unset(canopen::wall_now())};
}

// A machine without a clock of its own begins in 1970, or at the day of its systemd's release or of the last orderly
// end, whichever is later (systemd-timesyncd(8)). The last of these cannot be told from a clock that was set.
bool is_unset(canopen::WallTime now) noexcept {
  using namespace std::chrono;
  return now < sys_days(year(2025) / January / 1);
}

}  // namespace gateway
