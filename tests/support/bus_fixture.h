#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/bus/transmission.h"
#include "canopen/bus/virtual_link.h"
#include "tests/support/frame.h"
#include "tests/support/hand_driven_loop.h"

namespace support {

/// Another node: remembers what it hears.
class Listener final : public canopen::LinkEvents {
 public:
  explicit Listener(canopen::VirtualBus& bus) : link(bus.connect()) { link->open(*this); }
  void on_frames(std::span<const canopen::Received> frames) override {
    for (const canopen::Received& received : frames) {
      heard.push_back(received.frame);
    }
  }
  void on_echo(const canopen::Received&) override {}
  void on_bus_state(const canopen::BusState&) override {}
  void on_frames_lost(std::uint32_t) override {}

  [[nodiscard]] std::size_t count(std::uint32_t id) const {
    return static_cast<std::size_t>(
        std::count_if(heard.begin(), heard.end(), [&](const canopen::Frame& frame) { return frame.id == id; }));
  }

  std::unique_ptr<canopen::Link> link;
  std::vector<canopen::Frame> heard;
};

/// A link whose events a test makes by hand.
class HandLink final : public canopen::Link {
 public:
  explicit HandLink(canopen::LinkEvents*& events) : events_(events) {}
  void open(canopen::LinkEvents& events) override { events_ = &events; }
  void close() override { events_ = nullptr; }
  canopen::SendResult send(const canopen::Frame&) override { return canopen::SendResult::busy; }

 private:
  canopen::LinkEvents*& events_;
};

/// Sends a command and waits for its departure.
inline boost::asio::awaitable<canopen::Result<void>> send_command(canopen::Bus& bus, canopen::Frame frame,
                                                                  canopen::TimePoint deadline) {
  canopen::Transmission transmission(bus, canopen::TransmitClass::command, frame, deadline);
  canopen::Result<void> left = co_await transmission.result();
  co_return left;
}

inline constexpr canopen::BusSettings kQuiet{.bitrate = 125000, .node_id = 0, .heartbeat = {}};

class BusFixture : public ::testing::Test {
 protected:
  std::unique_ptr<canopen::Bus> start(const canopen::BusSettings& settings) {
    auto bus = std::make_unique<canopen::Bus>(loop.executor(), wire.connect(), settings);
    bus->start();
    loop.settle();
    return bus;
  }

  HandDrivenLoop loop;
  canopen::VirtualBus wire{loop.executor()};
  Listener other{wire};
};

}  // namespace support
