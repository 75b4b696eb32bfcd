// The file that keeps alarms: whatever the bytes, all of it or what is wrong, and what was read is written and read
// again the same.

#include <cstdint>
#include <cstdlib>
#include <string>

#include "bridges/alarms/alarm_memory.h"

namespace {

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  const alarms::ReadMemory read = alarms::parse_memory(text);
  if (!read.wrong.empty()) {
    require(read.memory == alarms::AlarmMemory{});
    return 0;
  }
  const alarms::ReadMemory again = alarms::parse_memory(alarms::memory_text(read.memory));
  require(again.wrong.empty() && again.memory == read.memory);
  return 0;
}
