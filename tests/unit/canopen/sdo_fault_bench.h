#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "canopen/clock.h"
#include "canopen/sdo/client.h"
#include "canopen/wake_up.h"
#include "tests/support/block_server.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

namespace canopen {

/// What happens to one frame on its way to or from a server, once.
enum class WireFault : std::uint8_t {
  none,
  request_lost,  ///< Of the client's frames that one,
  lost,          ///< of the server's that one.
  late,          ///< By more than the time of an answer, and all behind it.
  doubled,
  wrong_toggle,
  wrong_index,
  cut,                   ///< To three bytes.
  abort_without_code,    ///< In its place, and the server is reset.
  abort_without_object,  ///< Likewise.
  abort_of_another,      ///< Likewise: it names an object that nobody asked for.
  foreign_client         ///< Before it another client asks for another object.
};

/// A strict SDO server, node 5, on an in-process bus on which things go wrong.
class FaultyNode final : private LinkEvents {
 public:
  using Bytes = std::vector<std::uint8_t>;

  FaultyNode(boost::asio::any_io_executor executor, VirtualBus& bus)
      : link_(bus.connect()), other_(bus.connect()), wake_up_(std::move(executor), [this] { send_due(); }) {
    link_->open(*this);
    other_->open(nobody_);
  }

  support::BlockServer server{5};
  WireFault fault = WireFault::none;
  std::size_t at = 0;           ///< Which frame.
  std::vector<Frame> requests;  ///< Of the client under test, all of them.
  std::size_t frames = 0;       ///< Of the server, all of them.
  bool foreign_sent = false;

 private:
  struct Nobody final : LinkEvents {
    void on_frames(std::span<const Received>) override {}
    void on_echo(const Received&) override {}
    void on_bus_state(const BusState&) override {}
    void on_frames_lost(std::uint32_t) override {}
  };

  void on_frames(std::span<const Received> frames_heard) override {
    for (const Received& received : frames_heard) {
      if (received.frame.id == 0x605) {
        on_request(received.frame);
      }
    }
  }
  void on_echo(const Received&) override {}
  void on_bus_state(const BusState&) override {}
  void on_frames_lost(std::uint32_t) override {}

  void on_request(const Frame& frame) {
    const bool foreign = std::exchange(foreign_expected_, false);
    if (!foreign) {
      requests.push_back(frame);
      if (fault == WireFault::request_lost && requests.size() == at + 1) {
        return;
      }
    }
    for (const Frame& answer : server.answer(frame)) {
      spoil(answer);
    }
  }

  void spoil(Frame frame) {
    if (frames++ != at || fault == WireFault::request_lost) {
      push(frame);
      return;
    }
    switch (fault) {
      case WireFault::none:
      case WireFault::request_lost:
        break;
      case WireFault::lost:
        return;
      case WireFault::late:
        not_before_ = Clock::now() + std::chrono::milliseconds(700);
        break;
      case WireFault::doubled:
        push(frame);
        break;
      case WireFault::wrong_toggle:
        frame.data[0] ^= 0x10U;
        break;
      case WireFault::wrong_index:
        frame.data[1] ^= 0x01U;
        break;
      case WireFault::cut:
        frame.size = 3;
        break;
      case WireFault::abort_without_code:
        send_abort({0x80, 0x00, 0x20, 0x01});
        return;
      case WireFault::abort_without_object:
        send_abort({0x80, 0, 0, 0, 0x00, 0x00, 0x00, 0x08});
        return;
      case WireFault::abort_of_another:
        send_abort({0x80, 0x02, 0x20, 0x01, 0x00, 0x00, 0x00, 0x08});
        return;
      case WireFault::foreign_client:
        foreign_sent = true;
        foreign_expected_ = true;
        static_cast<void>(other_->send(make_frame(0x605, Bytes{0x40, 0x17, 0x10, 0, 0, 0, 0, 0})));
        break;
    }
    push(frame);
  }

  void send_abort(const Bytes& bytes) {
    static_cast<void>(server.answer(make_frame(0x605, Bytes{0x80, 0x00, 0x20, 0x01, 0, 0, 0, 8})));
    push(make_frame(0x585, bytes));
  }

  // A node answers in order.
  void push(const Frame& frame) {
    outgoing_.push_back({std::max(Clock::now(), not_before_), frame});
    send_due();
  }
  void send_due() {
    while (!outgoing_.empty() && outgoing_.front().at <= Clock::now()) {
      static_cast<void>(link_->send(outgoing_.front().frame));
      outgoing_.pop_front();
    }
    if (!outgoing_.empty()) {
      wake_up_.arm(outgoing_.front().at);
    }
  }

  struct Pending {
    TimePoint at;
    Frame frame;
  };

  std::unique_ptr<Link> link_;
  Nobody nobody_;
  std::unique_ptr<Link> other_;
  WakeUp wake_up_;
  std::deque<Pending> outgoing_;
  TimePoint not_before_{};
  bool foreign_expected_ = false;
};

/// An SDO client against that node, on the hand-driven clock. A bench is used for one fault.
class SdoFaultBench {
 public:
  using Bytes = std::vector<std::uint8_t>;
  static constexpr ObjectAddress kFile{0x2000, 1};
  static constexpr ObjectAddress kOther{0x2001, 0};

  explicit SdoFaultBench(SdoSettings settings = {}, std::optional<std::uint32_t> bitrate = std::nullopt)
      : wire_(loop.executor(), bitrate),
        bus(loop.executor(), wire_.connect(), settings_of_bus(bitrate)),
        node(loop.executor(), wire_),
        client(std::make_unique<SdoClient>(loop.executor(), bus, 5, settings)) {
    client->on_remark([this](std::string_view text) { remarks.emplace_back(text); });
    node.server.objects[{0x1000, 0}] = {1, 2, 3, 4};
    node.server.objects[{0x1017, 0}] = {100, 0};
    node.server.objects[kOther] = {7, 0};
    bus.start();
    loop.advance(std::chrono::milliseconds(2));
  }
  ~SdoFaultBench() {
    client->close();
    loop.settle();
    EXPECT_TRUE(client->idle());
    client.reset();
    const auto stopped = support::spawn(loop.executor(), bus.stop());
    loop.settle();
    EXPECT_TRUE(*stopped);
  }
  SdoFaultBench(const SdoFaultBench&) = delete;
  SdoFaultBench& operator=(const SdoFaultBench&) = delete;

  support::Spawned<Result<Bytes>> read(ObjectAddress object, std::size_t expected = 0) {
    return support::spawn(loop.executor(), client->read_bytes(object, expected));
  }
  support::Spawned<Result<void>> command(ObjectAddress object, const Bytes& data,
                                         Duration within = std::chrono::milliseconds(800)) {
    show_life();
    return support::spawn(loop.executor(), client->write_command(object, data, Clock::now() + within));
  }
  /// Commands leave only while the bus shows life.
  void show_life() {
    static_cast<void>(life_->send(make_frame(0x705, Bytes{5})));
    loop.advance(std::chrono::milliseconds(1));
  }
  static Bytes counted(std::size_t size, std::uint8_t from = 1) {
    Bytes bytes(size);
    std::iota(bytes.begin(), bytes.end(), from);
    return bytes;
  }
  /// Requests of ours that begin with this byte.
  [[nodiscard]] std::size_t begun_with(std::uint8_t first_byte) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(node.requests, [=](const Frame& frame) { return frame.data[0] == first_byte; }));
  }

  support::HandDrivenLoop loop;

 private:
  struct Nobody final : LinkEvents {
    void on_frames(std::span<const Received>) override {}
    void on_echo(const Received&) override {}
    void on_bus_state(const BusState&) override {}
    void on_frames_lost(std::uint32_t) override {}
  };
  static BusSettings settings_of_bus(std::optional<std::uint32_t> bitrate) {
    BusSettings settings;
    settings.bitrate = bitrate;
    settings.heartbeat = Duration::zero();
    return settings;
  }
  std::unique_ptr<Link> open_life() {
    std::unique_ptr<Link> link = wire_.connect();
    link->open(nobody_);
    return link;
  }

  VirtualBus wire_;
  Nobody nobody_;
  std::unique_ptr<Link> life_ = open_life();

 public:
  Bus bus;
  FaultyNode node;
  std::unique_ptr<SdoClient> client;
  std::vector<std::string> remarks;
};

}  // namespace canopen
