#include "bridges/net/connection_log.h"

#include <chrono>

namespace net {
namespace {

constexpr canopen::Duration kOnceIn = std::chrono::minutes(1);
// Of so many addresses and things a minute is told; of what comes beyond, only that it came.
constexpr std::size_t kMaxLines = 256;

}  // namespace

std::string ConnectionLog::line_of(const KeyView& key) const {
  return (protocol_ + ": ").append(key.first).append(": ").append(key.second);
}

void ConnectionLog::tell(std::string_view address, std::string_view what, const Sink& sink, bool own) {
  if (!sink) {
    return;
  }
  KeyView key(address, what);
  auto line = lines_.find(key);
  if (line == lines_.end() && !own && of_strangers_ >= kMaxLines) {
    key = {"further addresses", "more than the log tells of in a minute"};
    line = lines_.find(key);
  }
  if (line != lines_.end()) {
    ++line->second.untold;
    return;
  }
  lines_.emplace(key, Line{.told = canopen::Clock::now(), .untold = 0, .sink = &sink, .own = own});
  of_strangers_ += own ? 0 : 1;
  sink(line_of(key));
}

void ConnectionLog::sweep() {
  const canopen::TimePoint now = canopen::Clock::now();
  for (auto at = lines_.begin(); at != lines_.end();) {
    Line& line = at->second;
    if (now - line.told < kOnceIn) {
      ++at;
    } else if (line.untold == 0) {
      of_strangers_ -= line.own ? 0 : 1;
      at = lines_.erase(at);
    } else {
      (*line.sink)(line_of(at->first) + " (" + std::to_string(line.untold) + " times more in the last minute)");
      line = {.told = now, .untold = 0, .sink = line.sink, .own = line.own};
      ++at;
    }
  }
}

}  // namespace net
