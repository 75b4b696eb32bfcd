#include "daemon/control/record_answer.h"

#include <algorithm>
#include <chrono>

#include "bridges/text/json_text.h"
#include "daemon/control/answer.h"

namespace gateway::control {
namespace {

canopen::Error not_there(std::string detail) {
  return {.kind = canopen::ErrorKind::unknown, .detail = std::move(detail)};
}

std::string told(const std::string& id, const recorder::Recorder::Requested& requested) {
  std::string out;
  text::ObjectText object(out);
  object.key("id") += id;
  object.boolean("ok", true);
  object.text("record", requested.name);
  object.boolean("under_way", requested.was_under_way);
  object.integer("remaining_ms", std::chrono::ceil<std::chrono::milliseconds>(requested.remaining).count());
  object.close();
  return out;
}

}  // namespace

canopen::Error nothing_recorded() {
  return not_there("nothing is recorded: the configuration has no [recorder], or no state_dir");
}

std::string record_answer(const Asked& asked, const process::Plant& plant, const RecordRequest& request) {
  if (!request) {
    return refusal(asked.id, nothing_recorded());
  }
  std::size_t bus = 0;
  if (!asked.request.drive.empty()) {
    const process::Drive* const drive = plant.find(asked.request.drive);
    if (drive == nullptr) {
      return refusal(asked.id, not_there("no drive \"" + asked.request.drive + "\""));
    }
    bus = drive->bus();
  } else {
    const std::vector<config::Bus>& buses = plant.model().buses;
    const auto found = std::ranges::find(buses, asked.request.bus, &config::Bus::name);
    if (found == buses.end()) {
      return refusal(asked.id, not_there("no bus \"" + asked.request.bus + "\""));
    }
    bus = static_cast<std::size_t>(found - buses.begin());
  }
  const canopen::Result<recorder::Recorder::Requested> requested = request(bus, asked.request.drive, asked.user);
  return requested.has_error() ? refusal(asked.id, requested.error()) : told(asked.id, requested.value());
}

}  // namespace gateway::control
