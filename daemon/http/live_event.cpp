// How an event is worded. Apart from what the events are about, which needs all of the plant.

#include "daemon/http/live.h"

namespace gateway::http {

void Live::append_event(std::string& out, std::string_view name, std::string_view json) {
  out.append("event: ").append(name).append("\ndata: ").append(json).append("\n\n");
}

}  // namespace gateway::http
