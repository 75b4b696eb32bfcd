#include "canopen/survey/suspicion.h"

#include "canopen/survey/suspicion_words.h"

namespace canopen {
namespace {

constexpr std::uint16_t kWarningFrom = 96;  // Error counters, ISO 11898-1.
// A plug that is moved, or a drive that is switched, makes a few.
constexpr std::uint32_t kFewErrors = 5;
constexpr std::uint32_t kManyErrors = 10;
constexpr std::uint32_t kFramesForOneError = 1000;
// With less load frames of ours that wait have another reason.
constexpr std::uint16_t kHighLoad = 700;

bool is_in_trouble(const BusState& state) noexcept {
  return state.condition == BusCondition::passive || state.condition == BusCondition::bus_off;
}

bool looks_alone(const Signs& signs) noexcept {
  return signs.troubles.transmit == TransmitTrouble::not_acknowledged && signs.lately.errors.wire == 0 &&
         signs.bus_offs == 0;
}

// What a controller with another bit rate hears is no frame to it, and what it sends disturbs.
bool looks_like_bit_rate(const Signs& signs) noexcept {
  const bool disturbed = signs.lately.errors.wire >= kFewErrors || signs.bus_offs > 0 ||
                         signs.state.condition == BusCondition::bus_off || signs.state.receive_errors >= kWarningFrom;
  return !signs.heard_before && disturbed;
}

bool looks_like_wiring(const Signs& signs) noexcept {
  const std::uint32_t errors = signs.minute.errors.wire;
  const bool many = signs.minute.received > 0 && errors >= kManyErrors &&
                    std::uint64_t{errors} * kFramesForOneError >= signs.minute.received;
  const bool gone = signs.lately.received == 0 &&
                    (is_in_trouble(signs.state) || signs.bus_offs > 0 || signs.lately.errors.wire >= kFewErrors);
  return signs.heard_before && (many || signs.excursions || gone);
}

bool looks_overloaded(const Signs& signs) noexcept {
  return signs.troubles.overload ||
         (signs.load_per_mille >= kHighLoad && signs.troubles.transmit == TransmitTrouble::stuck);
}

}  // namespace

std::string_view name_of(SuspicionKind kind) noexcept {
  switch (kind) {
    case SuspicionKind::doubled_id:
      return "doubled_id";
    case SuspicionKind::alone:
      return "alone";
    case SuspicionKind::bit_rate:
      return "bit_rate";
    case SuspicionKind::wiring:
      return "wiring";
    case SuspicionKind::overload:
      break;
  }
  return "overload";
}

std::optional<Suspicion> judge(const Signs& signs) {
  if (signs.state.condition == BusCondition::down) {
    return std::nullopt;
  }
  if (signs.doubled || signs.troubles.own_node_id) {
    return suspect_doubled_id(signs);
  }
  if (looks_alone(signs)) {
    return suspect_alone(signs);
  }
  if (looks_like_bit_rate(signs)) {
    return suspect_bit_rate(signs);
  }
  if (looks_like_wiring(signs)) {
    return suspect_wiring(signs);
  }
  if (looks_overloaded(signs)) {
    return suspect_overload(signs);
  }
  return std::nullopt;
}

}  // namespace canopen
