#include "canopen/bus/bus.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <utility>

namespace canopen {

Bus::Bus(boost::asio::any_io_executor executor, std::unique_ptr<Link> link, BusSettings settings)
    : executor_(std::move(executor)),
      link_(std::move(link)),
      settings_(settings),
      bitrate_(settings.bitrate),
      sdo_budget_(executor_, settings.bitrate, settings.sdo_load, load_),
      queue_(*link_, TransmitTimes::at(settings.bitrate), has_heartbeat()),
      wake_up_(executor_, [this] { service(); }),
      // Of heartbeat and SYNC only the newest waits: the one before goes with its ticket.
      heartbeat_(executor_, heartbeat_frame(settings.node_id), settings.heartbeat,
                 [this](const Frame& frame) {
                   heartbeat_ticket_.reset();
                   heartbeat_ticket_ = send(TransmitClass::control, frame, Clock::now() + TransmitQueue::kLifeTime);
                 }),
      sync_(executor_, sync_frame(), settings.sync, [this](const Frame& frame) {
        sync_ticket_.reset();
        sync_ticket_ = send(TransmitClass::control, frame, Clock::now() + TransmitQueue::kLifeTime);
      }) {}

void Bus::start() {
  link_->open(*this);
}

boost::asio::awaitable<void> Bus::stop() {
  link_->close();
  told_ = false;
  state_ = BusState{};
  go_down();
  wake_up_.cancel();
  // Every command was answered just now; their coroutines end in the next turns of the loop.
  while (transmissions_ > 0) {
    co_await boost::asio::post(executor_, boost::asio::use_awaitable);
  }
}

Subscription Bus::subscribe(std::uint32_t cob_id, FrameHandler handler) {
  return dispatch_.subscribe(cob_id, std::move(handler));
}

Subscription Bus::subscribe_state(StateHandler handler) {
  const std::uint64_t id = state_handlers_.add(std::move(handler));
  return Subscription([this, id] { state_handlers_.remove(id); });
}

Subscription Bus::subscribe_losses(LossHandler handler) {
  const std::uint64_t id = loss_handlers_.add(std::move(handler));
  return Subscription([this, id] { loss_handlers_.remove(id); });
}

Subscription Bus::subscribe_timing(TimingHandler handler) {
  const std::uint64_t id = timing_handlers_.add(std::move(handler));
  return Subscription([this, id] { timing_handlers_.remove(id); });
}

Subscription Bus::add_tap(FrameTap& tap) {
  taps_.push_back(&tap);
  return Subscription([this, &tap] { std::erase(taps_, &tap); });
}

Ticket Bus::send(TransmitClass transmit_class, const Frame& frame, TimePoint until, Ticket::Told told) {
  Ticket ticket = queue_.push(transmit_class, frame, until, std::move(told), Clock::now());
  if (ticket) {
    service();
  }
  return ticket;
}

const BusStatistics& Bus::statistics() noexcept {
  if (bitrate_) {
    statistics_.bitrate = *bitrate_;
    statistics_.load_per_mille = load_.per_mille(*bitrate_, Clock::now());
    statistics_.highest_load_per_mille = load_.highest_per_mille(*bitrate_, Clock::now());
  }
  statistics_.error_frames = errors_.count();
  return statistics_;
}

TransmitSigns Bus::transmit_signs() const noexcept {
  return {.state = state_,
          .unsent_since = queue_.unsent_since(),
          .ack_error_at = ack_error_at_,
          .silent_since = silent_since_};
}

void Bus::on_frames(std::span<const Received> frames) {
  if (!state_.up()) {
    return;  // They are from before, and say nothing of the bus that is to come.
  }
  for (const Received& received : frames) {
    show_taps(received, FrameOrigin::others);
    ++statistics_.frames_received;
    errors_.add(false);
    load_.add(received.frame, received.at);
    silent_since_ = received.at;
    queue_.on_received(received.at);
    dispatch_.deliver(received);
  }
  // A command may have waited for a sign of life.
  if (!queue_.idle()) {
    service();
  }
}

void Bus::on_echo(const Received& sent) {
  if (!state_.up()) {
    return;
  }
  show_taps(sent, FrameOrigin::ourselves);
  ++statistics_.frames_sent;
  errors_.add(false);
  load_.add(sent.frame, sent.at);
  if (link_->echoes_prove_departure()) {
    ack_error_at_.reset();  // Somebody has acknowledged it.
    silent_since_ = std::max(silent_since_, sent.at);
  }
  queue_.on_echo(sent.frame, sent.at);
  service();
}

void Bus::on_bus_state(const BusState& state) {
  const BusState before = std::exchange(state_, state);
  if (std::exchange(told_, true) && state == before) {
    return;
  }
  if (state.condition == BusCondition::bus_off && before.condition != BusCondition::bus_off) {
    ++statistics_.bus_offs;
  }
  if (state.up() && !before.up()) {
    come_up();
  } else if (!state.up() && before.up()) {
    go_down();
  }
  state_handlers_.call(state);
}

void Bus::on_error_frame(const Received& error, ErrorSign sign) {
  show_taps(error, FrameOrigin::driver);
  errors_.add(true);
  if (sign == ErrorSign::not_acknowledged) {
    ack_error_at_ = Clock::now();
  }
}

void Bus::on_bit_timing(const BitTiming& timing) {
  bitrate_ = timing.bitrate;
  sdo_budget_.set_bitrate(timing.bitrate);
  queue_.set_times(TransmitTimes::at(timing.bitrate));
  timing_handlers_.call(timing);
}

void Bus::come_up() {
  silent_since_ = Clock::now();
  ack_error_at_.reset();
  queue_.on_bus(true);
  if (has_sync()) {
    sync_.start();
  }
  if (has_heartbeat()) {
    heartbeat_.start();
  }
}

void Bus::go_down() {
  heartbeat_.stop();
  sync_.stop();
  queue_.on_bus(false);
}

void Bus::on_frames_lost(std::uint32_t count) {
  for (FrameTap* const tap : taps_) {
    tap->on_frames_lost(count);
  }
  statistics_.frames_lost += count;
  queue_.on_frames_lost();
  service();
  loss_handlers_.call(count);
}

void Bus::show_taps(const Received& frame, FrameOrigin origin) {
  for (FrameTap* const tap : taps_) {
    tap->on_frame(frame, origin);
  }
}

void Bus::service() {
  const TimePoint now = Clock::now();
  queue_.service(now);
  if (has_heartbeat() && queue_.wants_heartbeat(now)) {
    // It asks the bus before a command does: where nobody acknowledges it, no command gets stuck behind it.
    heartbeat_.start();
  }
  if (const std::optional<TimePoint> next = queue_.next_time()) {
    wake_up_.arm_no_later_than(or_soon(*next, now));
  }
}

bool Bus::has_heartbeat() const noexcept {
  return settings_.node_id != 0 && settings_.heartbeat > Duration::zero();
}

}  // namespace canopen
