#include "daemon/http/process_figures.h"

#include <sys/resource.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <system_error>

namespace gateway::http {
namespace {

std::string read_all(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

double seconds_of(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) / 1e9;
}

// When the machine started. Not `btime` of /proc/stat: the unit hides that file (ProcSubset=pid).
double boot_time() {
  return seconds_of(CLOCK_REALTIME) - seconds_of(CLOCK_BOOTTIME);
}

std::uint64_t count_descriptors() {
  std::error_code failed;
  std::uint64_t count = 0;
  std::filesystem::directory_iterator entries("/proc/self/fd", failed);
  for (const auto end = std::filesystem::directory_iterator(); !failed && entries != end; entries.increment(failed)) {
    ++count;
  }
  return count > 0 ? count - 1 : 0;  // but for the one that looks
}

// The fields behind the name, which may hold blanks and brackets: the first of them is the third of the file.
void read_stat(ProcessFigures& figures) {
  const std::string text = read_all("/proc/self/stat");
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) {
    return;
  }
  std::istringstream fields(text.substr(name_end + 1));
  std::string skipped;
  for (int field = 3; field < 14; ++field) {
    fields >> skipped;
  }
  double user = 0;
  double system = 0;
  fields >> user >> system;
  for (int field = 16; field < 22; ++field) {
    fields >> skipped;
  }
  double started = 0;
  std::uint64_t pages = 0;
  fields >> started >> figures.virtual_bytes >> pages;
  if (fields) {
    static const double booted = boot_time();  // It moves when the time of day is set; a start does not.
    const auto ticks = static_cast<double>(::sysconf(_SC_CLK_TCK));
    figures.cpu_seconds = (user + system) / ticks;
    figures.start_time = booted + started / ticks;
    figures.resident_bytes = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  }
}

}  // namespace

ProcessFigures process_figures() {
  ProcessFigures figures;
  read_stat(figures);
  figures.open_descriptors = count_descriptors();
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) == 0) {
    figures.max_descriptors = limit.rlim_cur;
  }
  return figures;
}

}  // namespace gateway::http
