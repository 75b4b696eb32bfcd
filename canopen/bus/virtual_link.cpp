#include "canopen/bus/virtual_link.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <tuple>
#include <utility>

#include "canopen/bus/bus_load.h"

namespace canopen {

/// One plug on a VirtualBus.
class VirtualLink final : public Link {
 public:
  explicit VirtualLink(VirtualBus& bus) : bus_(bus) {}
  ~VirtualLink() override { bus_.remove(*this); }

  void open(LinkEvents& events) override {
    events_ = &events;
    bus_.tell_state(*this);
  }
  void close() override { events_ = nullptr; }
  SendResult send(const Frame& frame) override { return bus_.accept(*this, frame); }

  [[nodiscard]] LinkEvents* events() const noexcept { return events_; }
  /// What waits for a bus with a bit rate.
  [[nodiscard]] std::deque<Frame>& outbox() noexcept { return outbox_; }

 private:
  VirtualBus& bus_;
  LinkEvents* events_ = nullptr;
  std::deque<Frame> outbox_;
};

VirtualBus::Wire::Wire(VirtualBus& bus, std::uint32_t bits_per_second)
    : bitrate(bits_per_second), end_of_frame(bus.executor_, [&bus] { bus.end_frame(); }) {}

VirtualBus::VirtualBus(boost::asio::any_io_executor executor, std::optional<std::uint32_t> bitrate)
    : executor_(std::move(executor)) {
  if (bitrate) {
    wire_.emplace(*this, *bitrate);
  }
}

VirtualBus::~VirtualBus() {
  *alive_ = false;
}

std::unique_ptr<Link> VirtualBus::connect() {
  auto link = std::make_unique<VirtualLink>(*this);
  links_.push_back(link.get());
  return link;
}

void VirtualBus::set_state(const BusState& state) {
  state_ = state;
  if (!state_.up()) {
    queue_.clear();
    if (wire_) {
      wire_->frame.reset();
      wire_->end_of_frame.cancel();
    }
  }
  for (VirtualLink* link : links_) {
    if (link == nullptr) {
      continue;
    }
    if (!state_.up()) {
      link->outbox().clear();
    }
    tell_state(*link);
  }
}

std::optional<TimePoint> VirtualBus::next_departure() const noexcept {
  return wire_ && wire_->frame ? std::optional(wire_->departure) : std::nullopt;
}

SendResult VirtualBus::accept(VirtualLink& sender, const Frame& frame) {
  if (!state_.up()) {
    return SendResult::down;
  }
  if ((wire_ ? sender.outbox().size() : queue_.size()) >= kCapacity) {
    return SendResult::busy;
  }
  if (wire_) {
    sender.outbox().push_back(frame);
  } else {
    queue_.push_back({&sender, frame});
  }
  schedule();
  return SendResult::handed_over;
}

void VirtualBus::schedule() {
  if (scheduled_) {
    return;
  }
  scheduled_ = true;
  boost::asio::post(executor_, [this, alive = alive_] {
    if (!*alive) {
      return;
    }
    if (wire_) {
      scheduled_ = false;
      begin_frame();
    } else {
      deliver();
    }
  });
}

void VirtualBus::deliver() {
  scheduled_ = false;
  // Only what waits now: answers given meanwhile go with the next turn, so that the loop stays fair.
  for (std::size_t count = queue_.size(); count > 0 && !queue_.empty(); --count) {
    const Pending pending = queue_.front();
    queue_.pop_front();
    deliver_one(pending);
  }
  if (!queue_.empty()) {
    schedule();
  }
}

/// Arbitration: among the first frames of all links the lowest identifier goes, a data frame before a request for it.
void VirtualBus::begin_frame() {
  if (wire_->frame) {
    return;
  }
  const auto priority = [](const Frame& frame) { return std::tuple(frame.id, frame.remote); };
  VirtualLink* winner = nullptr;
  for (VirtualLink* link : links_) {
    if (link == nullptr || link->outbox().empty()) {
      continue;
    }
    if (winner == nullptr || priority(link->outbox().front()) < priority(winner->outbox().front())) {
      winner = link;
    }
  }
  if (winner == nullptr) {
    return;
  }
  wire_->frame = Pending{winner, winner->outbox().front()};
  winner->outbox().pop_front();
  const std::uint64_t bits = bits_on_wire(wire_->frame->frame);
  wire_->departure = Clock::now() + std::chrono::nanoseconds(bits * std::nano::den / wire_->bitrate);
  wire_->end_of_frame.arm(wire_->departure);
}

void VirtualBus::end_frame() {
  if (const std::optional<Pending> passed = std::exchange(wire_->frame, std::nullopt)) {
    deliver_one(*passed);
    begin_frame();
  }
}

void VirtualBus::deliver_one(const Pending& pending) {
  const TimePoint now = Clock::now();
  const Received received{pending.frame, now, wall_now()};
  delivering_ = true;
  // By position, and only the links of now: a receiver may plug and unplug links while it handles the frame.
  const std::size_t count = links_.size();
  for (std::size_t i = 0; i < count; ++i) {
    VirtualLink* link = links_[i];
    if (link == nullptr || link->events() == nullptr) {
      continue;
    }
    if (link != pending.sender) {
      link->events()->on_frames({&received, 1});
    } else if (!withhold_echoes_) {
      link->events()->on_echo(received);
    }
  }
  delivering_ = false;
  std::erase(links_, nullptr);
}

void VirtualBus::tell_state(VirtualLink& link) {
  boost::asio::post(executor_, [this, alive = alive_, target = &link] {
    if (!*alive || std::find(links_.begin(), links_.end(), target) == links_.end()) {
      return;
    }
    if (target->events() != nullptr) {
      target->events()->on_bus_state(state_);
    }
  });
}

void VirtualBus::remove(const VirtualLink& link) {
  // During a delivery its place is kept, so that no other link is passed over.
  for (VirtualLink*& plugged : links_) {
    if (plugged == &link) {
      plugged = nullptr;
    }
  }
  if (!delivering_) {
    std::erase(links_, nullptr);
  }
  for (Pending& pending : queue_) {
    if (pending.sender == &link) {
      pending.sender = nullptr;
    }
  }
  if (wire_ && wire_->frame && wire_->frame->sender == &link) {
    wire_->frame->sender = nullptr;  // It passes all the same.
  }
}

}  // namespace canopen
