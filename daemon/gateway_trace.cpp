// What of the gateway serves the trace.

#include <utility>
#include <vector>

#include "bridges/trace/feed.h"
#include "daemon/gateway.h"

namespace gateway {

std::unique_ptr<trace::Feed> Gateway::make_trace() {
  std::vector<canopen::Bus*> buses;
  for (const BusInUse& in_use : buses_) {
    buses.push_back(in_use.bus.get());
  }
  return std::make_unique<trace::Feed>(plant_.model(), std::move(buses));
}

}  // namespace gateway
