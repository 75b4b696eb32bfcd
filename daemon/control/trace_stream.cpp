#include "daemon/control/trace_stream.h"

#include <utility>

#include "bridges/text/json_text.h"
#include "bridges/trace/candump.h"
#include "bridges/trace/line.h"
#include "config/log_interface.h"

namespace gateway::control {

TraceStream::TraceStream(trace::Feed& feed, trace::Filter filter, std::string id, bool raw)
    : reader_(feed, std::move(filter)), id_(std::move(id)), raw_(raw) {}

bool TraceStream::take(std::string& lines) {
  if (const std::uint64_t lost = reader_.take_lost(); lost > 0) {
    text::ObjectText object(lines);
    object.key("id") += id_;
    object.integer("lost", static_cast<std::int64_t>(lost));
    object.close();
    lines += '\n';
  }
  return reader_.take(kMostAtOnce, [&](const trace::Entry& entry) { append(lines, entry); });
}

void TraceStream::append(std::string& lines, const trace::Entry& entry) const {
  const config::Model& model = reader_.model();
  text::ObjectText object(lines);
  object.key("id") += id_;
  if (raw_ && entry.lost > 0) {
    object.integer("lost_frames", entry.lost);
    object.text("bus", model.buses.at(entry.bus.value_or(0)).name);
  } else if (raw_) {
    const config::Bus& bus = model.buses.at(entry.bus.value_or(0));
    object.text("raw", trace::candump_line(entry.at, config::log_interface(bus), entry.frame));
  } else {
    trace::append_members(object, trace::line_of(model, entry));
  }
  object.close();
  lines += '\n';
}

}  // namespace gateway::control
