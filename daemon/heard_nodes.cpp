#include "daemon/heard_nodes.h"

#include <fmt/format.h>

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

NodeWatch::NodeWatch(const boost::asio::any_io_executor& executor, canopen::Link& link)
    : link_(link), timer_(executor) {}

NodeWatch::~NodeWatch() {
  close();
}

void NodeWatch::close() {
  if (std::exchange(open_, false)) {
    link_.close();
  }
}

boost::asio::awaitable<std::map<std::uint8_t, std::string>> NodeWatch::listen(canopen::Duration time) {
  open_ = true;
  link_.open(*this);
  // A change of the bus ends the waiting, and it begins again.
  for (bool whole = false; !whole && !stopped_;) {
    timer_.expires_at(up_ ? canopen::Clock::now() + time : canopen::kNever);
    boost::system::error_code woken;
    co_await timer_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, woken));
    whole = !woken && up_;
  }
  close();
  co_return heard_;
}

void NodeWatch::stop() {
  stopped_ = true;
  timer_.cancel();
}

void NodeWatch::on_frames(std::span<const canopen::Received> frames) {
  for (const canopen::Received& received : frames) {
    if (std::optional<HeardNode> heard = sender_of(received.frame)) {
      heard_.try_emplace(heard->node, std::move(heard->by));
    }
  }
}

void NodeWatch::on_bus_state(const canopen::BusState& state) {
  if (up_ != state.up()) {
    up_ = state.up();
    timer_.cancel();
  }
}

}  // namespace gateway
