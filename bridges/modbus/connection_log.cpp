#include "bridges/modbus/connection_log.h"

#include <chrono>

namespace modbus {
namespace {

constexpr canopen::Duration kOnceIn = std::chrono::minutes(1);
// Of so many addresses and things a minute is told; of what comes beyond, only that it came.
constexpr std::size_t kMaxLines = 256;

std::string line_of(const std::string& address, const std::string& what) {
  return "Modbus: " + address + ": " + what;
}

}  // namespace

void ConnectionLog::tell(const std::string& address, const std::string& what, const Sink& sink) {
  if (!sink) {
    return;
  }
  sweep();
  std::pair<std::string, std::string> key(address, what);
  if (lines_.size() >= kMaxLines && !lines_.contains(key)) {
    key = {"further addresses", "more than the log tells of in a minute"};
  }
  const auto [line, is_new] = lines_.try_emplace(key, Line{.told = canopen::Clock::now(), .untold = 0, .sink = &sink});
  if (is_new) {
    sink(line_of(key.first, key.second));
  } else {
    ++line->second.untold;
  }
}

void ConnectionLog::sweep() {
  const canopen::TimePoint now = canopen::Clock::now();
  for (auto at = lines_.begin(); at != lines_.end();) {
    Line& line = at->second;
    if (now - line.told < kOnceIn) {
      ++at;
    } else if (line.untold == 0) {
      at = lines_.erase(at);
    } else {
      (*line.sink)(line_of(at->first.first, at->first.second) + " (" + std::to_string(line.untold) +
                   " times more in the last minute)");
      line = {.told = now, .untold = 0, .sink = line.sink};
      ++at;
    }
  }
}

}  // namespace modbus
