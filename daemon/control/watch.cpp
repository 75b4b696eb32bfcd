// `status --watch`: the table again and again.

#include <unistd.h>

#include <string>

#include "daemon/control/ask.h"
#include "daemon/control/follow.h"
#include "daemon/control/status_table.h"
#include "daemon/output.h"

namespace gateway::control {
namespace {

// Over what stood there before, so that nothing flickers: to the upper left, each line and then the rest emptied.
std::string redrawn(const std::string& table) {
  std::string text = "\x1b[H";
  for (const char letter : table) {
    text += letter == '\n' ? std::string("\x1b[K\n") : std::string(1, letter);
  }
  return text + "\x1b[J";
}

}  // namespace

int watch_status(const Reach& reach, bool as_json) {
  const bool redraws = ::isatty(STDOUT_FILENO) == 1 && !as_json;
  if (redraws) {
    print("\x1b[2J");
  }
  std::string shown;
  return follow_stream(reach, R"({"id":1,"op":"status","watch":true})", [&](std::string_view line) {
    const std::string_view status = only_member(line, "status");
    if (as_json) {
      print(std::string(status) + "\n");
      return;
    }
    if (redraws) {
      print(redrawn(status_table(status).value_or("")));
      return;
    }
    // Into a pipe only what tells something new.
    std::string lasting = status_table(status, TableAges::hidden).value_or("");
    if (lasting != shown) {
      shown = std::move(lasting);
      print(status_time(status) + "  " + status_table(status).value_or("") + "\n");
    }
  });
}

}  // namespace gateway::control
