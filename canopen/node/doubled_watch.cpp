#include "canopen/node/doubled_watch.h"

#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/cob_id.h"
#include "canopen/nmt_frame.h"
#include "canopen/node/heartbeat_consumer.h"

namespace canopen {
namespace {

constexpr std::uint8_t kSlowestSyncTpdo = 240;  // CiA 301 table 67: 1 to 240 follow the SYNC.

bool follows_sync(const PdoSettings& tpdo) {
  const std::uint8_t type = tpdo.transmission_type.value_or(0);
  return type >= 1 && type <= kSlowestSyncTpdo && tpdo.period > Duration::zero();
}

}  // namespace

DoubledWatch::DoubledWatch(const boost::asio::any_io_executor& executor, Bus& bus, const NodeSettings& settings,
                           std::function<bool(std::uint16_t)> is_sure, std::function<void()> on_change)
    : bus_(bus),
      settings_(settings),
      is_sure_(std::move(is_sure)),
      on_change_(std::move(on_change)),
      id_(settings.error_control.heartbeat, settings.self_starting),
      timer_(executor, [this] { service(); }) {
  for (const PdoSettings& tpdo : settings_.tpdos) {
    if (follows_sync(tpdo)) {
      tpdos_.push_back({.number = tpdo.number});
      tpdos_.back().rate.set_period(tpdo.period);
    }
  }
}

void DoubledWatch::start() {
  subscriptions_.push_back(bus_.subscribe(kNmtCobId, [this](const Received& received) { on_foreign_nmt(received); }));
  subscriptions_.push_back(bus_.subscribe_losses([this](std::uint32_t) { on_frames_lost(); }));
  std::size_t next = 0;
  for (const PdoSettings& tpdo : settings_.tpdos) {
    if (follows_sync(tpdo)) {
      subscriptions_.push_back(bus_.subscribe(tpdo.cob_id, [this, &watched = tpdos_[next++]](const Received& received) {
        on_sync_tpdo(watched, received);
      }));
    }
  }
  if (!tpdos_.empty()) {
    subscriptions_.push_back(
        bus_.subscribe(kSyncCobId, [this](const Received& received) { foreign_sync_at_ = received.at; }));
  }
}

void DoubledWatch::stop() {
  subscriptions_.clear();
  timer_.cancel();
}

void DoubledWatch::on_nmt(NmtCommand command) {
  id_.on_nmt(command, Clock::now());
}

void DoubledWatch::on_second_answer(bool different) {
  id_.on_second_answer(different, Clock::now());
  service();
}

void DoubledWatch::end() {
  id_.end();
  service();
}

void DoubledWatch::on_error_control(const HeartbeatMessage& message, TimePoint at) {
  if (message.boot_up) {
    id_.on_boot_up(at);
  } else {
    id_.on_heartbeat(message.state, at);
  }
  service();
}

// Our own commands come back as echoes, which are never dispatched.
void DoubledWatch::on_foreign_nmt(const Received& received) {
  const std::optional<std::uint8_t> specifier = nmt_specifier_for(received.frame, settings_.node);
  if (const std::optional<NmtCommand> command = specifier ? nmt_command_of(*specifier) : std::nullopt) {
    id_.on_nmt(*command, received.at);
  }
}

/// Beside another SYNC than ours it may well come more often.
void DoubledWatch::on_sync_tpdo(SyncTpdo& tpdo, const Received& received) {
  const bool beside = foreign_sync_at_ && received.at - *foreign_sync_at_ < DoubledId::kForgotten;
  if (beside || !is_sure_(tpdo.number)) {
    tpdo.rate.begin_anew();
  } else if (tpdo.rate.hear(received.at)) {
    id_.on_doubled_tpdo(tpdo.number, received.at);
    service();
  }
}

void DoubledWatch::on_frames_lost() {
  id_.on_frames_lost();
  for (SyncTpdo& tpdo : tpdos_) {
    tpdo.rate.begin_anew();
  }
}

void DoubledWatch::service() {
  id_.look(Clock::now());
  if (id_.next() != kNever) {
    timer_.arm_no_later_than(id_.next());
  }
  if (std::exchange(told_, id_.verdict()) != id_.verdict()) {
    on_change_();
  }
}

}  // namespace canopen
