#include <memory>
#include <string>
#include <utility>

#include "bridges/text/json_text.h"
#include "bridges/trace/feed.h"
#include "bridges/trace/line.h"
#include "daemon/http/event_source.h"
#include "daemon/http/live.h"
#include "daemon/http/respond.h"

namespace gateway::http {
namespace {

// `event: frame` for each, `event: lost` where the reader was too slow for so many.
class TraceEvents final : public EventSource {
 public:
  TraceEvents(trace::Feed& feed, trace::Filter filter) : reader_(feed, std::move(filter)) {}

  bool take(std::string& events) override {
    if (const std::uint64_t lost = reader_.take_lost(); lost > 0) {
      Live::append_event(events, "lost", "{\"frames\":" + std::to_string(lost) + "}");
    }
    // Wording one takes some 4 us, and whoever asks by Modbus meanwhile waits for all of a piece.
    constexpr std::size_t kMostAtOnce = 8;
    return reader_.take(kMostAtOnce, [&](const trace::Entry& entry) {
      std::string json;
      text::ObjectText object(json);
      trace::append_members(object, trace::line_of(reader_.model(), entry));
      object.close();
      Live::append_event(events, "frame", json);
    });
  }
  canopen::Duration pace() const override { return std::chrono::milliseconds(200); }

 private:
  trace::Feed::Reader reader_;
};

std::string parameter(const Target& target, std::string_view name) {
  const std::string* const value = target.find(name);
  return value == nullptr ? std::string() : *value;
}

}  // namespace

Answer trace_frames(const Site& site, const Target& target) {
  const std::string drive = parameter(target, "drive");
  if (const std::string* const named = target.find("drive"); named != nullptr && site.plant.find(*named) == nullptr) {
    return refusal(404, "there is no drive \"" + std::string(beginning(*named)) + "\"", "drives",
                   drive_names(site.plant.model()));
  }
  canopen::Result<trace::Filter> filter =
      trace::make_filter(site.plant.model(), {.names = drive, .kinds = parameter(target, "kind")});
  if (filter.has_error()) {
    return refusal(400, filter.error().detail);
  }
  if (site.trace == nullptr) {
    return refusal(404, "this gateway has no trace");
  }
  return {.type = "text/event-stream", .stream = true, .events = [feed = site.trace, chosen = filter.value()] {
            return std::make_unique<TraceEvents>(*feed, chosen);
          }};
}

}  // namespace gateway::http
