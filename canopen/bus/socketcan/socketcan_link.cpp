#include "canopen/bus/socketcan/socketcan_link.h"

#include <linux/can.h>
#include <sys/socket.h>

#include <array>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <optional>
#include <utility>

#include "canopen/bus/socketcan/driver.h"
#include "canopen/bus/socketcan/error_frame.h"
#include "canopen/bus/socketcan/interface_bell.h"
#include "canopen/bus/socketcan/interface_query.h"
#include "canopen/bus/socketcan/interface_state.h"
#include "canopen/bus/socketcan/raw_socket.h"
#include "canopen/bus/socketcan/readable.h"
#include "canopen/bus/socketcan/receive_batch.h"
#include "canopen/bus/socketcan/receive_clock.h"
#include "canopen/wake_up.h"

namespace canopen {
namespace {

using socketcan::Interface;
using socketcan::Readable;
using socketcan::ReceiveBatch;

// The interface is asked for again should an error frame have been lost or the bell have been deaf. The question may
// have to wait for others in the kernel (rtnl lock), so it is put less often while all is well.
constexpr Duration kLookAgain = std::chrono::seconds(1);
constexpr Duration kLookAtHealthy = std::chrono::seconds(5);
// After a frame that a bus-off controller cannot receive.
constexpr Duration kLookSoon = std::chrono::milliseconds(20);

bool tells_that_it_is_gone(int error) noexcept {
  return error == ENODEV || error == ENXIO || error == ENETUNREACH || error == ENETDOWN;
}

class SocketCanLink final : public Link {
 public:
  SocketCanLink(boost::asio::any_io_executor executor, std::string interface, EchoProves echo, LinkNotice notice)
      : executor_(std::move(executor)),
        name_(std::move(interface)),
        echo_(echo),
        notice_(notice ? std::move(notice) : [](const std::string&) {}),
        look_again_(executor_, [this] { look(); }),
        count_again_(executor_, [this] { count_losses(socketcan::dropped_so_far(socket_->get())); }) {}

  void open(LinkEvents& events) override;
  void close() override;
  SendResult send(const Frame& frame) override;
  TimePoint heard_until() override;
  [[nodiscard]] bool echoes_prove_departure() const noexcept override { return proves_departure_; }

 private:
  /// Asks for the interface, opens or closes the socket, and tells a changed state.
  void look();
  void open_socket(const Interface& interface);
  void drop_socket();  ///< With all that waits in it, which is from before.
  void tell_of_limits(const std::array<std::string, 2>& limits);
  void tell(const BusState& state);
  void tell_timing(const std::optional<BitTiming>& timing);

  [[nodiscard]] bool receive();
  void deliver(std::size_t count);
  void count_losses(std::optional<std::uint32_t> dropped);
  void on_error_frame(const Received& error);

  boost::asio::any_io_executor executor_;
  std::string name_;
  EchoProves echo_;
  LinkNotice notice_;
  LinkEvents* events_ = nullptr;  ///< Nothing: closed.
  std::optional<socketcan::InterfaceQuery> query_;
  std::optional<Readable> bell_;
  std::optional<Readable> socket_;
  int interface_index_ = 0;        ///< Of the socket.
  int failed_index_ = 0;           ///< Of the interface whose socket could not be opened.
  bool proves_departure_ = false;  ///< Of the socket's interface.
  int told_index_ = 0;             ///< Of the interface whose limits were told of.
  bool gone_ = false;              ///< A frame could not be sent, since the socket's interface went away.
  WakeUp look_again_;
  WakeUp count_again_;
  ReceiveBatch batch_;
  socketcan::ReceiveClock clock_;
  std::optional<TimePoint> delivered_until_;  ///< While a batch is being delivered.
  std::array<Received, ReceiveBatch::kCapacity> received_{};
  std::uint32_t dropped_ = 0;  ///< The kernel's count for this socket, as told.
  std::optional<BusState> told_;
  std::optional<BitTiming> told_timing_;
};

void SocketCanLink::open(LinkEvents& events) {
  events_ = &events;
  query_.emplace();
  bell_.emplace(executor_, socketcan::open_interface_bell(), [this] {
    socketcan::silence_interface_bell(bell_->get());
    look();
    return false;
  });
  look_again_.arm(Clock::now());
}

void SocketCanLink::close() {
  events_ = nullptr;
  look_again_.cancel();
  bell_.reset();
  drop_socket();
  query_.reset();
  told_.reset();
  told_timing_.reset();
}

SendResult SocketCanLink::send(const Frame& frame) {
  if (!socket_) {
    return SendResult::down;
  }
  const can_frame raw = socketcan::to_kernel(frame);
  if (::send(socket_->get(), &raw, sizeof raw, MSG_DONTWAIT) == static_cast<ssize_t>(sizeof raw)) {
    return SendResult::handed_over;
  }
  // EAGAIN: our own send buffer is full; ENOBUFS: the interface's queue is, and the socket counts as writable all the
  // while, so that waiting for it would spin. Both end with an echo or after a pause.
  if (errno == EAGAIN || errno == ENOBUFS || errno == EINTR || errno == ENOMEM) {
    return SendResult::busy;
  }
  gone_ = gone_ || tells_that_it_is_gone(errno);
  look_again_.arm_no_later_than(Clock::now());
  return SendResult::down;
}

TimePoint SocketCanLink::heard_until() {
  const TimePoint now = Clock::now();
  if (!socket_) {
    return now;
  }
  if (delivered_until_) {
    return *delivered_until_;  // Of what was read together, something may wait behind the frame that is handled now.
  }
  if (socketcan::has_something_to_read(socket_->get())) {
    return clock_.heard_until();
  }
  // Where the socket ran over, the newest frames are lost, and the kernel tells so with the next one only. Silence must
  // not be decided without knowing of them.
  if (socketcan::dropped_so_far(socket_->get()).value_or(dropped_) != dropped_) {
    count_again_.arm_no_later_than(now);
    return clock_.heard_until();
  }
  return now;
}

void SocketCanLink::look() {
  if (std::exchange(gone_, false)) {
    drop_socket();
    tell(BusState{});
  }
  if (events_ == nullptr) {
    return;
  }
  look_again_.arm(Clock::now() + kLookAgain);
  const socketcan::InterfaceQuery::Answer answer = query_->ask(name_);
  if (answer.error) {
    return;  // Nothing is known now; what was known stays until the next look.
  }
  const BusState state =
      answer.interface ? socketcan::state_of(*answer.interface, told_.value_or(BusState{})) : BusState{};
  if (state.condition == BusCondition::down) {
    drop_socket();
    if (!answer.interface) {
      failed_index_ = 0;
    }
    tell(state);
    return;
  }
  if (socket_ && interface_index_ != answer.interface->index) {
    gone_ = true;  // Another interface took its name.
    return look();
  }
  tell_timing(answer.interface->timing);  // Before the state: what waits for the bus to come up needs it.
  if (!socket_) {
    open_socket(*answer.interface);
  }
  if (socket_ && state.condition == BusCondition::error_active) {
    look_again_.arm(Clock::now() + kLookAtHealthy);
  }
  tell(socket_ ? state : BusState{});
}

void SocketCanLink::open_socket(const Interface& interface) {
  socketcan::RawSocket opened = socketcan::open_raw_socket(interface.index);
  if (opened.error) {
    if (std::exchange(failed_index_, interface.index) != interface.index) {
      notice_(name_ + ": no CAN socket: " + opened.error.message());
    }
    return;
  }
  failed_index_ = 0;
  dropped_ = 0;
  interface_index_ = interface.index;
  clock_.start(Clock::now());
  socket_.emplace(executor_, std::move(opened.descriptor), [this] { return receive(); });
  const std::string driver = socketcan::driver_of(socket_->get(), name_);
  const std::string no_departure = socketcan::no_departure_notice(echo_, interface.echoes, driver);
  proves_departure_ = no_departure.empty();
  if (std::exchange(told_index_, interface.index) != interface.index) {
    tell_of_limits({socketcan::small_buffer_notice(opened.receive_buffer), no_departure});
  }
}

void SocketCanLink::drop_socket() {
  count_again_.cancel();
  socket_.reset();
  interface_index_ = 0;
}

void SocketCanLink::tell_of_limits(const std::array<std::string, 2>& limits) {
  for (const std::string& text : limits) {
    if (!text.empty()) {
      notice_(name_ + ": " + text);
    }
  }
}

void SocketCanLink::tell_timing(const std::optional<BitTiming>& timing) {
  if (events_ != nullptr && timing && told_timing_ != timing) {
    told_timing_ = timing;
    events_->on_bit_timing(*timing);
  }
}

void SocketCanLink::tell(const BusState& state) {
  if (events_ != nullptr && told_ != state) {
    told_ = state;
    events_->on_bus_state(state);
  }
}

/// One batch, then others get their turn. Returns whether more waits.
bool SocketCanLink::receive() {
  const int count = batch_.read(socket_->get());
  if (count > 0) {
    delivered_until_ = clock_.heard_until();
    deliver(static_cast<std::size_t>(count));
    delivered_until_.reset();
  } else if (count < 0 && errno != EAGAIN && errno != EINTR) {
    // ENETDOWN, ENODEV: told once, before the frames that wait; the interface went down or away. It may be back by now
    // with the same index, and this socket would stay deaf.
    gone_ = true;
    look();
  }
  return count == static_cast<int>(ReceiveBatch::kCapacity);
}

void SocketCanLink::deliver(std::size_t count) {
  const WallTime wall = wall_now();
  const TimePoint now = Clock::now();
  clock_.set(now, wall);
  std::size_t collected = 0;
  const auto hand_over_collected = [&] {
    if (collected > 0 && events_ != nullptr) {
      if (told_ && told_->condition == BusCondition::bus_off) {
        look_again_.arm_no_later_than(now + kLookSoon);  // It has recovered, and the error frame that told so is lost.
      }
      events_->on_frames(std::span(received_).first(std::exchange(collected, 0)));
    }
  };
  for (std::size_t i = 0; i < count; ++i) {
    const ReceiveBatch::Item item = batch_.item(i);
    const TimePoint at = clock_.at(item.wall);
    // In the order of reception, so everything before goes first.
    if (item.echo || item.frame.error || (item.dropped && *item.dropped != dropped_)) {
      hand_over_collected();
    }
    count_losses(item.dropped);
    if (events_ == nullptr) {
      return;
    }
    if (item.frame.error) {
      on_error_frame({item.frame, at, item.wall});
    } else if (item.echo) {
      events_->on_echo({item.frame, at, item.wall});
    } else {
      received_[collected++] = {item.frame, at, item.wall};
    }
  }
  hand_over_collected();
}

void SocketCanLink::count_losses(std::optional<std::uint32_t> dropped) {
  // The count wraps. A frame that waited while its successors were dropped has a count from before.
  const std::uint32_t lost = dropped.value_or(dropped_) - dropped_;
  if (events_ == nullptr || lost == 0 || lost > UINT32_MAX / 2) {
    return;
  }
  dropped_ += lost;
  look_again_.arm_no_later_than(Clock::now());  // An error frame may have been among them.
  events_->on_frames_lost(lost);
}

void SocketCanLink::on_error_frame(const Received& error) {
  look_again_.arm_no_later_than(Clock::now() + kLookAgain);
  const Frame& frame = error.frame;
  const bool alone = socketcan::tells_no_acknowledge(frame);
  events_->on_error_frame(error, alone ? ErrorSign::not_acknowledged : ErrorSign::other);
  if (socketcan::tells_overrun(frame)) {
    events_->on_frames_lost(1);
  }
  if (told_ && told_->condition != BusCondition::down && socketcan::tells_more_than_an_error(frame)) {
    tell(socketcan::after_error_frame(*told_, frame));
  }
}

}  // namespace

std::unique_ptr<Link> make_socketcan_link(boost::asio::any_io_executor executor, std::string interface,
                                          LinkNotice notice, EchoProves echo) {
  return std::make_unique<SocketCanLink>(std::move(executor), std::move(interface), echo, std::move(notice));
}

}  // namespace canopen
