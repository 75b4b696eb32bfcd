#include "daemon/control/streams.h"

#include <memory>
#include <utility>

#include "daemon/control/trace_stream.h"
#include "daemon/control/watch_stream.h"

namespace gateway::control {

OpenStream stream_source(const process::Plant& plant, trace::Feed& feed, Surveys surveys) {
  const canopen::TimePoint started = canopen::Clock::now();
  return [&plant, &feed, started, surveys = std::move(surveys)](
             const Request& request, const std::string& id) -> canopen::Result<std::unique_ptr<Stream>> {
    if (request.op == Op::status) {
      return std::make_unique<WatchStream>(plant, id, started, surveys);
    }
    canopen::Result<trace::Filter> filter =
        trace::make_filter(feed.model(), {request.names, request.kinds, request.cob_ids});
    if (filter.has_error()) {
      return filter.error();
    }
    return std::make_unique<TraceStream>(feed, std::move(filter.value()), id, request.raw);
  };
}

}  // namespace gateway::control
