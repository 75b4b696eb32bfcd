#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/bus/transmission.h"
#include "canopen/bus/virtual_link.h"
#include "canopen/node/outputs.h"
#include "tests/support/gated_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

// The RPDOs of one node on a bus, with somebody who hears them.
namespace canopen::outputs {

inline constexpr std::uint8_t kNode = 5;
inline constexpr ObjectAddress kControl{0x6040, 0};
inline constexpr ObjectAddress kTarget{0x6042, 0};
inline constexpr Duration kEventTimer = std::chrono::milliseconds(300);
inline constexpr Duration kPeriod = std::chrono::milliseconds(100);

inline ObjectValue control(Raw raw) {
  return {kControl, DataType::u16, raw};
}

inline ObjectValue target(Raw raw) {
  return {kTarget, DataType::u16, raw};
}

inline PdoSettings supervised() {
  return {.cob_id = 0x205, .event_timer = 300, .mapping = {{.object = kControl}, {.object = kTarget}}};
}

/// What was commanded, as its owner would tell it.
struct CommandedImage {
  bool repeats = true;
  std::optional<ObjectValue> control{};
  std::optional<ObjectValue> target{};

  [[nodiscard]] std::optional<ObjectValue>& of(ObjectAddress object) { return object == kControl ? control : target; }
  [[nodiscard]] std::optional<Outputs::Values> repetition(std::uint16_t number) const {
    return repeats && number == 1 && control && target ? std::optional(Outputs::Values{*control, *target})
                                                       : std::nullopt;
  }
};

class OutputsTest : public testing::Test {
 protected:
  /// An RPDO on the wire, and how long after the begin of the record.
  using Heard = std::pair<Duration, std::vector<int>>;
  using Sent = support::Spawned<Result<void>>;

  OutputsTest() {
    bus_.start();
    drive_.start();
    loop_.advance(std::chrono::milliseconds(1));
  }
  ~OutputsTest() override {
    outputs_.cease();
    const auto idle = support::spawn(loop_.executor(), outputs_.until_idle());
    loop_.settle();
    EXPECT_TRUE(*idle);
    for (Bus* bus : {&bus_, &drive_}) {
      const auto stopped = support::spawn(loop_.executor(), bus->stop());
      loop_.settle();
      EXPECT_TRUE(*stopped);
    }
  }

  static BusSettings without_heartbeat() { return {.heartbeat = Duration::zero()}; }
  /// Its heartbeat is the sign of life that commands need.
  static BusSettings drive() { return {.node_id = kNode}; }

  /// The image has the values once they have left.
  Sent send(Outputs::Values values, Duration within = std::chrono::milliseconds(800),
            TransmitClass transmit_class = TransmitClass::command) {
    return support::spawn(loop_.executor(), send_and_note(std::move(values), transmit_class, Clock::now() + within));
  }
  /// Control 15 and target 100 have left, and the record begins with that.
  void run() {
    const Sent sent = send({control(15), target(100)});
    loop_.settle();
    ASSERT_TRUE(sent.done());
    ASSERT_TRUE(sent.get().has_value());
    begin_record();
  }
  void begin_record() {
    begun_ = Clock::now();
    heard_.clear();
  }
  /// An SDO write that the drive answers `after` its request has left.
  std::shared_ptr<bool> write(const ObjectValue& value, Duration after) {
    return support::spawn(loop_.executor(), write_and_note(value, after));
  }
  [[nodiscard]] Duration longest_gap() const {
    Duration longest = Clock::now() - begun_ - (heard_.empty() ? Duration::zero() : heard_.back().first);
    Duration last{};
    for (const Heard& each : heard_) {
      longest = std::max(longest, each.first - last);
      last = each.first;
    }
    return longest;
  }

  support::HandDrivenLoop loop_;
  VirtualBus wire_{loop_.executor()};
  bool closed_ = false;  ///< Nothing of ours can leave.
  Bus bus_{loop_.executor(), std::make_unique<support::GatedLink>(wire_.connect(), closed_), without_heartbeat()};
  Bus drive_{loop_.executor(), wire_.connect(), drive()};
  TimePoint begun_{};
  std::vector<Heard> heard_;
  Subscription rpdos_ = drive_.subscribe(0x205, [this](const Received& received) {
    heard_.push_back({received.at - begun_, {received.frame.data[0], received.frame.data[2]}});
  });
  std::vector<PdoSettings> settings_{supervised()};
  CommandedImage image_;
  Outputs outputs_{loop_.executor(), bus_, kNode, settings_,
                   [this](std::uint16_t number) { return image_.repetition(number); }};

 private:
  boost::asio::awaitable<Result<void>> send_and_note(Outputs::Values values, TransmitClass transmit_class,
                                                     TimePoint deadline) {
    const Result<void> left = co_await outputs_.send(1, values, transmit_class, deadline);
    if (left.has_value()) {
      for (const ObjectValue& value : values) {
        image_.of(value.object) = value;
      }
    }
    co_return left;
  }
  boost::asio::awaitable<void> write_and_note(ObjectValue value, Duration after) {
    outputs_.hold(value.object);
    const Result<void> left = co_await request();
    if (left.has_value()) {
      Timer answer(loop_.executor(), after);
      co_await answer.async_wait(boost::asio::use_awaitable);
      image_.of(value.object) = value;
      outputs_.refresh(value.object);
    }
  }
  boost::asio::awaitable<Result<void>> request() {
    const Frame frame = make_frame(0x605, std::vector<std::uint8_t>(8, 0x2B));
    Transmission sending(bus_, TransmitClass::command, frame, Clock::now() + std::chrono::milliseconds(800));
    co_return co_await sending.result();
  }
};

}  // namespace canopen::outputs
