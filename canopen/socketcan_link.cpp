#include "canopen/socketcan_link.h"

#include <linux/can.h>
#include <sys/socket.h>

#include <array>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <optional>
#include <utility>

#include "canopen/socketcan/error_frame.h"
#include "canopen/socketcan/interface_bell.h"
#include "canopen/socketcan/interface_query.h"
#include "canopen/socketcan/raw_socket.h"
#include "canopen/socketcan/readable.h"
#include "canopen/socketcan/receive_batch.h"
#include "canopen/wake_up.h"

namespace canopen {
namespace {

using socketcan::Interface;
using socketcan::Readable;
using socketcan::ReceiveBatch;

// The controller's state and counters are read once a second where the driver tells them: an error frame may be lost.
// As often a missing interface is looked for, should the bell have been deaf.
constexpr Duration kLookAgain = std::chrono::seconds(1);

class SocketCanLink final : public Link {
 public:
  SocketCanLink(boost::asio::any_io_executor executor, std::string interface, LinkNotice notice)
      : executor_(std::move(executor)),
        name_(std::move(interface)),
        notice_(std::move(notice)),
        look_again_(executor_, [this] { look(); }) {}

  void open(LinkEvents& events) override;
  void close() override;
  SendResult send(const Frame& frame) override;

 private:
  /// Asks for the interface, opens or closes the socket, and tells a changed state.
  void look();
  void open_socket(const Interface& interface);
  [[nodiscard]] BusState state_of(const Interface& interface) const noexcept;
  void tell(const BusState& state);
  void notice(const std::string& text) const;

  void receive();
  void deliver(std::size_t count);
  void count_losses(const ReceiveBatch::Item& item);
  void on_error_frame(const Frame& frame);

  boost::asio::any_io_executor executor_;
  std::string name_;
  LinkNotice notice_;
  LinkEvents* events_ = nullptr;  ///< Nothing: closed.
  std::optional<socketcan::InterfaceQuery> query_;
  std::optional<Readable> bell_;
  std::optional<Readable> socket_;
  int interface_index_ = 0;  ///< Of the socket.
  int failed_index_ = 0;     ///< Of the interface whose socket could not be opened.
  WakeUp look_again_;
  ReceiveBatch batch_;
  std::array<Received, ReceiveBatch::kCapacity> received_{};
  std::uint32_t dropped_ = 0;  ///< The kernel's count for this socket as of the last frame.
  std::optional<BusState> told_;
};

void SocketCanLink::open(LinkEvents& events) {
  events_ = &events;
  query_.emplace();
  bell_.emplace(executor_, socketcan::open_interface_bell(), [this] {
    socketcan::silence_interface_bell(bell_->get());
    look();
  });
  look_again_.arm(Clock::now());
}

void SocketCanLink::close() {
  events_ = nullptr;
  look_again_.cancel();
  bell_.reset();
  socket_.reset();
  query_.reset();
  interface_index_ = 0;
  told_.reset();
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
  look_again_.arm(Clock::now());
  return SendResult::down;
}

void SocketCanLink::look() {
  look_again_.arm(Clock::now() + kLookAgain);
  const socketcan::InterfaceQuery::Answer answer = query_->ask(name_);
  if (answer.error) {
    return;  // Nothing is known now; what was known stays until the next look.
  }
  if (!answer.interface) {
    socket_.reset();
    interface_index_ = 0;
    failed_index_ = 0;
    tell(BusState{});
    return;
  }
  if (interface_index_ != answer.interface->index) {
    open_socket(*answer.interface);
  }
  tell(socket_ ? state_of(*answer.interface) : BusState{});
}

void SocketCanLink::open_socket(const Interface& interface) {
  socket_.reset();
  interface_index_ = 0;
  socketcan::RawSocket opened = socketcan::open_raw_socket(interface.index);
  if (opened.error) {
    if (std::exchange(failed_index_, interface.index) != interface.index) {
      notice(name_ + ": no CAN socket: " + opened.error.message());
    }
    return;
  }
  failed_index_ = 0;
  dropped_ = 0;
  interface_index_ = interface.index;
  socket_.emplace(executor_, std::move(opened.descriptor), [this] { receive(); });
  if (opened.receive_buffer < socketcan::kWantedReceiveBuffer) {
    notice(name_ + ": receive buffer of " + std::to_string(opened.receive_buffer) + " bytes instead of " +
           std::to_string(socketcan::kWantedReceiveBuffer) +
           ": frames may be lost in bursts; raise it with sysctl net.core.rmem_max");
  }
  if (!interface.echoes_departure) {
    notice(name_ +
           ": the driver does not tell when a frame has left (no IFF_ECHO): a command counts as sent when the " +
           "kernel has taken it");
  }
}

BusState SocketCanLink::state_of(const Interface& interface) const noexcept {
  const BusState before = told_.value_or(BusState{});
  if (!interface.administratively_up) {
    return BusState{};
  }
  if (interface.condition) {
    BusState state = before;
    state.condition = *interface.condition;
    if (interface.counters) {
      state.transmit_errors = interface.counters->transmit;
      state.receive_errors = interface.counters->receive;
    }
    return state.condition == BusCondition::down ? BusState{} : state;
  }
  if (!interface.carrier) {
    // The driver tells no state: an error frame may have told of a bus-off, else the other end is missing.
    return before.condition == BusCondition::bus_off ? before : BusState{};
  }
  return before.condition == BusCondition::down ? BusState{BusCondition::error_active, 0, 0} : before;
}

void SocketCanLink::tell(const BusState& state) {
  if (events_ != nullptr && told_ != state) {
    told_ = state;
    events_->on_bus_state(state);
  }
}

void SocketCanLink::notice(const std::string& text) const {
  if (notice_) {
    notice_(text);
  }
}

// One batch, then others get their turn.
void SocketCanLink::receive() {
  const int count = batch_.read(socket_->get());
  if (count > 0) {
    deliver(static_cast<std::size_t>(count));
  } else if (count < 0 && errno != EAGAIN && errno != EINTR) {
    // ENETDOWN, ENODEV: told once; the interface went down or away.
    look();
  }
}

void SocketCanLink::deliver(std::size_t count) {
  const TimePoint now = Clock::now();
  std::size_t collected = 0;
  const auto hand_over_collected = [&] {
    if (collected > 0 && events_ != nullptr) {
      events_->on_frames(std::span(received_).first(std::exchange(collected, 0)));
    }
  };
  for (std::size_t i = 0; i < count; ++i) {
    const ReceiveBatch::Item item = batch_.item(i);
    // In the order of reception, so everything before goes first.
    if (item.echo || item.frame.error || (item.dropped && *item.dropped != dropped_)) {
      hand_over_collected();
    }
    if (events_ == nullptr) {
      return;
    }
    count_losses(item);
    if (item.frame.error) {
      on_error_frame(item.frame);
    } else if (item.echo) {
      events_->on_echo(item.frame, now);
    } else {
      received_[collected++] = {item.frame, now, item.wall};
    }
    if (events_ == nullptr) {
      return;
    }
  }
  hand_over_collected();
}

void SocketCanLink::count_losses(const ReceiveBatch::Item& item) {
  if (!item.dropped || *item.dropped == dropped_) {
    return;
  }
  const std::uint32_t lost = *item.dropped - std::exchange(dropped_, *item.dropped);
  events_->on_frames_lost(lost);
}

void SocketCanLink::on_error_frame(const Frame& frame) {
  if (events_ != nullptr && socketcan::tells_overrun(frame)) {
    events_->on_frames_lost(1);
  }
  if (events_ != nullptr && told_ && told_->condition != BusCondition::down) {
    tell(socketcan::after_error_frame(*told_, frame));
  }
}

}  // namespace

std::unique_ptr<Link> make_socketcan_link(boost::asio::any_io_executor executor, std::string interface,
                                          LinkNotice notice) {
  return std::make_unique<SocketCanLink>(std::move(executor), std::move(interface), std::move(notice));
}

}  // namespace canopen
