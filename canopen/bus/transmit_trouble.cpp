#include "canopen/bus/transmit_trouble.h"

namespace canopen {
namespace {

constexpr std::uint16_t kPassiveFrom = 128;  // Error counters, ISO 11898-1.

bool passive_by_sending(const BusState& state) noexcept {
  return state.condition == BusCondition::passive && state.transmit_errors >= kPassiveFrom &&
         state.receive_errors < kPassiveFrom;
}

}  // namespace

TransmitTrouble judge_transmission(const TransmitSigns& signs, TimePoint now) noexcept {
  if (!signs.state.up()) {
    return TransmitTrouble::none;
  }
  const bool alone = now - signs.silent_since >= kTransmitPatience;
  const bool ack_error = signs.ack_error_at && now - *signs.ack_error_at < kAckErrorCounts;
  if (alone && (ack_error || passive_by_sending(signs.state))) {
    return TransmitTrouble::not_acknowledged;
  }
  const bool stuck = signs.unsent_since && now - *signs.unsent_since >= kTransmitPatience;
  return stuck ? TransmitTrouble::stuck : TransmitTrouble::none;
}

}  // namespace canopen
