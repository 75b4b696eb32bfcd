#include "daemon/heard_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <string_view>
#include <utility>

namespace gateway {
namespace {

constexpr std::uint32_t kNodeBits = 0x7F;
constexpr std::uint32_t kErrorControl = 0x700;

struct Service {
  std::uint32_t base;
  std::string_view name;
};
constexpr std::array<Service, 6> kSent{{{0x080, "an emergency"},
                                        {0x180, "its TPDO1"},
                                        {0x280, "its TPDO2"},
                                        {0x380, "its TPDO3"},
                                        {0x480, "its TPDO4"},
                                        {0x580, "an SDO answer"}}};

std::string_view name_of_error_control(const canopen::Frame& frame) {
  return frame.size == 1 && frame.data[0] == 0 ? "its boot-up" : "its heartbeat";
}

}  // namespace

std::optional<HeardNode> sender_of(const canopen::Frame& frame) {
  const auto node = static_cast<std::uint8_t>(frame.id & kNodeBits);
  if (frame.remote || frame.extended || frame.error || node == 0 || frame.id > canopen::kMaxCobId) {
    return std::nullopt;
  }
  const std::uint32_t base = frame.id & ~kNodeBits;
  std::string_view name;
  if (base == kErrorControl) {
    name = name_of_error_control(frame);
  }
  for (const Service& service : kSent) {
    if (service.base == base) {
      name = service.name;
    }
  }
  if (name.empty()) {
    return std::nullopt;
  }
  return HeardNode{.node = node, .by = fmt::format("{} (0x{:03X})", name, frame.id)};
}

/// One of the buses.
class NodeWatch::Ear final : public canopen::LinkEvents {
 public:
  Ear(NodeWatch& watch, canopen::Link& link) : watch_(watch), link_(link) {}
  ~Ear() { close(); }
  Ear(const Ear&) = delete;
  Ear& operator=(const Ear&) = delete;

  void open() {
    open_ = true;
    link_.open(*this);
  }
  void close() {
    if (std::exchange(open_, false)) {
      link_.close();
    }
  }
  [[nodiscard]] bool up() const noexcept { return up_; }
  [[nodiscard]] const HeardNodes& heard() const noexcept { return heard_; }

 private:
  void on_frames(std::span<const canopen::Received> frames) override {
    for (const canopen::Received& received : frames) {
      if (std::optional<HeardNode> heard = sender_of(received.frame)) {
        heard_.try_emplace(heard->node, std::move(heard->by));
      }
    }
  }
  void on_echo(const canopen::Received& /*sent*/) override {}
  void on_bus_state(const canopen::BusState& state) override {
    if (up_ != state.up()) {
      up_ = state.up();
      heard_.clear();  // Who was there may have been unplugged.
      watch_.begin_anew();
    }
  }
  void on_frames_lost(std::uint32_t /*count*/) override {}

  NodeWatch& watch_;
  canopen::Link& link_;
  HeardNodes heard_;
  bool open_ = false;
  bool up_ = false;
};

NodeWatch::NodeWatch(const boost::asio::any_io_executor& executor) : timer_(executor) {}

NodeWatch::~NodeWatch() = default;

void NodeWatch::add(canopen::Link& link) {
  ears_.push_back(std::make_unique<Ear>(*this, link));
}

boost::asio::awaitable<std::vector<HeardNodes>> NodeWatch::listen(canopen::Duration time) {
  for (const auto& ear : ears_) {
    ear->open();
  }
  for (bool whole = false; !whole && !stopped_;) {
    broken_ = false;
    timer_.expires_at(all_up() ? canopen::Clock::now() + time : canopen::kNever);
    boost::system::error_code woken;
    co_await timer_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, woken));
    whole = !woken && !broken_ && all_up();
  }
  std::vector<HeardNodes> heard;
  for (const auto& ear : ears_) {
    ear->close();
    heard.push_back(ear->heard());
  }
  co_return heard;
}

void NodeWatch::stop() {
  stopped_ = true;
  timer_.cancel();
}

bool NodeWatch::all_up() const {
  return std::ranges::all_of(ears_, &Ear::up);
}

void NodeWatch::begin_anew() {
  broken_ = true;
  timer_.cancel();
}

}  // namespace gateway
