#include "canopen/bus_core.h"

#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <optional>
#include <utility>

namespace canopen {
namespace {

Error offline_error() {
  return {.kind = ErrorKind::offline, .detail = "the bus is down, or takes no command until a frame of ours has left"};
}

Error withdrawn_error() {
  return {.kind = ErrorKind::timeout, .detail = "not sent before its deadline; withdrawn"};
}

Error unknown_error() {
  return {.kind = ErrorKind::timeout, .outcome_unknown = true, .detail = "its departure was not seen"};
}

}  // namespace

/// One command on its way: lives in the coroutine that waits for it, and withdraws the command when that goes.
class Bus::Core::PendingCommand {
 public:
  PendingCommand(Core& core, const Frame& frame, TimePoint deadline) : core_(core), timer_(core.executor_) {
    ++core_.pending_commands_;
    timer_.expires_at(TimePoint::max());
    ticket_ = core_.queue_.push_command(
        frame, deadline,
        [this](Departure departure) {
          departure_ = departure;
          timer_.cancel();
        },
        Clock::now());
    core_.service();
  }
  ~PendingCommand() {
    core_.queue_.cancel(ticket_);
    --core_.pending_commands_;
  }
  PendingCommand(const PendingCommand&) = delete;
  PendingCommand& operator=(const PendingCommand&) = delete;

  [[nodiscard]] std::optional<Departure> departure() const noexcept { return departure_; }
  [[nodiscard]] Timer& timer() noexcept { return timer_; }

 private:
  Core& core_;
  Timer timer_;
  std::optional<Departure> departure_;
  TransmitQueue::Ticket ticket_ = 0;
};

Bus::Core::Core(boost::asio::any_io_executor executor, std::unique_ptr<Link> link, BusSettings settings)
    : executor_(std::move(executor)),
      link_(std::move(link)),
      settings_(settings),
      queue_(*link_),
      wake_up_(executor_, [this] { service(); }),
      heartbeat_(executor_, heartbeat_frame(settings.node_id), settings.heartbeat,
                 [this](const Frame& frame) { send(frame, &TransmitQueue::push_latest); }),
      sync_(executor_, sync_frame(), settings.sync,
            [this](const Frame& frame) { send(frame, &TransmitQueue::push_latest); }) {}

void Bus::Core::start() {
  link_->open(*this);
}

boost::asio::awaitable<void> Bus::Core::stop() {
  link_->close();
  told_ = false;
  state_ = BusState{};
  go_down();
  wake_up_.cancel();
  // Every command was answered just now; their coroutines end in the next turns of the loop.
  while (pending_commands_ > 0) {
    co_await boost::asio::post(executor_, boost::asio::use_awaitable);
  }
}

bool Bus::Core::send(const Frame& frame, bool (TransmitQueue::*push)(const Frame&, TimePoint)) {
  if (!(queue_.*push)(frame, Clock::now())) {
    return false;
  }
  service();
  return true;
}

boost::asio::awaitable<Result<void>> Bus::Core::send_command(Frame frame, TimePoint deadline) {
  PendingCommand command(*this, frame, deadline);
  if (!command.departure()) {
    boost::system::error_code cancelled;
    co_await command.timer().async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, cancelled));
  }
  switch (command.departure().value_or(Departure::offline)) {
    case Departure::left:
      co_return Result<void>();
    case Departure::withdrawn:
      co_return withdrawn_error();
    case Departure::unknown:
      co_return unknown_error();
    case Departure::offline:
      break;
  }
  co_return offline_error();
}

const BusStatistics& Bus::Core::statistics() {
  if (settings_.bitrate) {
    statistics_.load_per_mille = load_.per_mille(*settings_.bitrate, Clock::now());
  }
  return statistics_;
}

void Bus::Core::on_frames(std::span<const Received> frames) {
  if (!state_.up()) {
    return;  // They are from before, and say nothing of the bus that is to come.
  }
  for (const Received& received : frames) {
    ++statistics_.frames_received;
    load_.add(received.frame, received.at);
    queue_.on_received(received.at);
    dispatch_.deliver(received);
  }
  // A command may have waited for a sign of life.
  if (!queue_.idle()) {
    service();
  }
}

void Bus::Core::on_echo(const Frame& frame, TimePoint at) {
  if (!state_.up()) {
    return;
  }
  ++statistics_.frames_sent;
  load_.add(frame, at);
  queue_.on_echo(frame, at);
  if (!queue_.idle()) {
    service();
  }
}

void Bus::Core::on_bus_state(const BusState& state) {
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

void Bus::Core::come_up() {
  queue_.on_bus(true);
  if (has_sync()) {
    sync_.start();
  }
  if (has_heartbeat()) {
    heartbeat_.start();
  }
}

void Bus::Core::go_down() {
  heartbeat_.stop();
  sync_.stop();
  queue_.on_bus(false);
}

void Bus::Core::on_frames_lost(std::uint32_t count) {
  statistics_.frames_lost = static_cast<std::uint16_t>(statistics_.frames_lost + count);
  loss_handlers_.call(count);
}

void Bus::Core::service() {
  const TimePoint now = Clock::now();
  queue_.service(now);
  if (has_heartbeat() && queue_.wants_sign_of_life(now)) {
    // Our heartbeat asks the bus before a command does: where nobody acknowledges it, no command gets stuck behind it.
    heartbeat_.start();
  }
  if (const std::optional<TimePoint> next = queue_.next_time()) {
    wake_up_.arm_no_later_than(*next);
  }
}

bool Bus::Core::has_heartbeat() const noexcept {
  return settings_.node_id != 0 && settings_.heartbeat > Duration::zero();
}

}  // namespace canopen
