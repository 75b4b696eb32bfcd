#include "canopen/bus/bus_watch.h"

#include <algorithm>
#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/cob_id.h"
#include "canopen/node/node_settings.h"
#include "canopen/sdo/frames.h"

namespace canopen {
namespace {

constexpr std::uint8_t kHighestNodeId = 127;

constexpr Duration kStep = std::chrono::milliseconds(200);
// Of the load in one second, in per mille.
constexpr unsigned kOverload = 900;
constexpr unsigned kNoOverload = 800;

}  // namespace

BusWatch::BusWatch(const boost::asio::any_io_executor& executor, Bus& bus, bool other_master, Handlers handlers)
    : bus_(bus), other_master_(other_master), handlers_(std::move(handlers)), timer_(executor, [this] { look(); }) {}

void BusWatch::watch_commands_to(const NodeSettings& node) {
  for (const PdoSettings& rpdo : node.rpdos) {
    if (std::any_of(rpdo.mapping.begin(), rpdo.mapping.end(), is_commanded)) {
      commands_.push_back(bus_.subscribe(
          rpdo.cob_id, [this, id = node.node](const Received& received) { hear(MasterSign::rpdo, received.at, id); }));
    }
  }
}

void BusWatch::start() {
  subscribe();
  timer_.arm(Clock::now() + kStep);
}

// Our own frames come back as echoes, which are never dispatched: whatever comes here is somebody else's.
void BusWatch::subscribe() {
  subscriptions_.push_back(bus_.subscribe(kNmtCobId, [this](const Received& received) { on_nmt(received); }));
  if (bus_.settings().sync > Duration::zero()) {
    subscriptions_.push_back(
        bus_.subscribe(kSyncCobId, [this](const Received& received) { hear(MasterSign::sync, received.at); }));
  }
  for (std::uint8_t node = 1; node <= kHighestNodeId; ++node) {
    subscriptions_.push_back(bus_.subscribe(
        kSdoRequestBase + node, [this, node](const Received& received) { hear(MasterSign::sdo, received.at, node); }));
  }
  if (const std::uint8_t own = bus_.settings().node_id; own != 0) {
    subscriptions_.push_back(bus_.subscribe(kErrorControlBase + own, [this](const Received& received) {
      own_id_at_ = received.at;
      tell();
    }));
  }
}

void BusWatch::on_nmt(const Received& received) {
  if (received.frame.bytes().size() >= 2) {
    hear(MasterSign::nmt, received.at, received.frame.data[1], received.frame.data[0]);
  }
}

void BusWatch::hear(MasterSign sign, TimePoint at, std::uint8_t node, std::uint8_t command) {
  if (!second_master_.hear(sign, at, node, command)) {
    return;
  }
  if (other_master_) {
    handlers_.remark(second_master_.text());
  } else {
    tell();
  }
}

void BusWatch::look() {
  const TimePoint now = Clock::now();
  second_master_.forget(now);
  if (own_id_at_ && now - *own_id_at_ >= SecondMaster::kForgotten) {
    own_id_at_.reset();
  }
  tell();
  timer_.arm(now + kStep);
}

bool BusWatch::is_overloaded() const {
  const unsigned load = bus_.statistics().load_per_mille;
  return troubles_.overload ? load >= kNoOverload : load > kOverload;
}

TransmitTrouble BusWatch::transmit_trouble() const {
  const TransmitSigns signs = bus_.transmit_signs();
  const TimePoint now = Clock::now();
  const TransmitTrouble trouble = judge_transmission(signs, now);
  // After a stall the echo, or the frames of others, may lie in the socket. Asking costs system calls.
  return trouble == TransmitTrouble::none ? trouble : judge_transmission(signs, std::min(now, bus_.heard_until()));
}

void BusWatch::tell() {
  BusTroubles now{.transmit = transmit_trouble(),
                  .own_node_id = own_id_at_.has_value(),
                  .overload = is_overloaded(),
                  .second_master = other_master_ ? std::string() : second_master_.text()};
  if (now != troubles_) {
    troubles_ = std::move(now);
    handlers_.changed(troubles_);
  }
}

}  // namespace canopen
