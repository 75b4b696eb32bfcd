#include "canopen/survey/suspicion_words.h"

namespace canopen {
namespace {

constexpr unsigned kPercent = 10;  // per mille

std::string number(std::uint64_t value) {
  return std::to_string(value);
}

std::string in_last_minute(const ErrorCounts& errors) {
  return errors.wire == 0 ? std::string()
                          : number(errors.wire) + " errors in the last minute (" + text_of(errors) + ")";
}

std::string controller(const BusState& state) {
  std::string_view condition = "is error-active";
  switch (state.condition) {
    case BusCondition::bus_off:
      condition = "is bus-off";
      break;
    case BusCondition::passive:
      condition = "is error-passive";
      break;
    case BusCondition::warning:
      condition = "is at its warning level";
      break;
    case BusCondition::error_active:
    case BusCondition::down:
      break;
  }
  return std::string("the controller ").append(condition) + " (" + number(state.transmit_errors) + " transmit, " +
         number(state.receive_errors) + " receive errors)";
}

void append(std::string& list, const std::string& part) {
  if (!part.empty()) {
    list.append(list.empty() ? "" : "; ").append(part);
  }
}

}  // namespace

std::string_view describe(SuspicionKind kind) noexcept {
  switch (kind) {
    case SuspicionKind::doubled_id:
      return "a node id may be there twice";
    case SuspicionKind::alone:
      return "the gateway may be alone on the bus";
    case SuspicionKind::bit_rate:
      return "the bit rate may be wrong";
    case SuspicionKind::wiring:
      return "wiring or termination may be bad";
    case SuspicionKind::overload:
      break;
  }
  return "the bus may be overloaded";
}

std::string Suspicion::text(std::string_view age) const {
  return std::string(describe(kind)).append(age) + ": " + seen + ". Look first at " + look;
}

Suspicion suspect_doubled_id(const Signs& signs) {
  if (!signs.doubled) {
    return {.kind = SuspicionKind::doubled_id,
            .seen = "another node sends heartbeats with the gateway's node id",
            .look = "other masters and tools on this bus, then at the node_id of this gateway"};
  }
  return {.kind = SuspicionKind::doubled_id,
          .seen = "node " + number(signs.doubled->node) + ": " + signs.doubled->text,
          .look = "drives that were exchanged or added, and the node id that each is set to"};
}

Suspicion suspect_alone(const Signs& signs) {
  return {.kind = SuspicionKind::alone,
          .seen = "nobody acknowledges our frames and nobody else is heard, but nothing disturbs either; " +
                  controller(signs.state),
          .look =
              "whether the drives have power and the bus cable is plugged at the gateway, then at a break in the "
              "cable and at the drives' bit rate"};
}

Suspicion suspect_bit_rate(const Signs& signs) {
  std::string seen = std::string("no frame was received since ") +
                     (signs.saw_it_come_up ? "the interface came up" : "the gateway opened the interface") + "; " +
                     controller(signs.state);
  append(seen, in_last_minute(signs.minute.errors));
  append(seen, signs.bus_offs == 0 ? "" : "bus-off in the last minute");
  const std::string ours =
      signs.bitrate == 0 ? "the bit rate of the interface" : "the bit rate, here " + number(signs.bitrate) + " bit/s";
  return {
      .kind = SuspicionKind::bit_rate,
      .seen = std::move(seen),
      .look = ours +
              ", and that of each drive; then at CAN_H and CAN_L that are swapped or touch each other, and where the "
              "bus worked before at its cable, plugs and terminators"};
}

Suspicion suspect_wiring(const Signs& signs) {
  std::string seen;
  append(seen, in_last_minute(signs.minute.errors));
  append(seen, signs.lately.received == 0
                   ? "frames were received before, and none in the last " + number(Signs::kLately) + " s"
                   : number(signs.minute.received) + " frames received in the last minute");
  append(seen, signs.excursions ? "the controller left error-active several times in ten minutes" : "");
  append(seen, controller(signs.state));
  return {.kind = SuspicionKind::wiring,
          .seen = std::move(seen),
          .look =
              "the two terminators (with all power off 60 ohms between CAN_H and CAN_L), then at plugs, shield, "
              "stubs and motor cables beside the bus, and for one device with another bit rate"};
}

Suspicion suspect_overload(const Signs& signs) {
  std::string seen = "load " + number(signs.load_per_mille / kPercent) + " %";
  append(seen, signs.troubles.transmit == TransmitTrouble::stuck ? "frames of ours wait" : "");
  append(seen, signs.busiest.empty() ? "" : "the most frequent COB-ID is " + signs.busiest);
  return {.kind = SuspicionKind::overload,
          .seen = std::move(seen),
          .look = "inhibit times and periods of the TPDOs that come most often, then at the bit rate"};
}

}  // namespace canopen
