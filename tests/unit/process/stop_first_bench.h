#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "tests/unit/process/commands_fixture.h"

namespace process {

/// Stops beside slow writes, and when they are on the wire.
class StopFirstTest : public CommandsTest {
 protected:
  static constexpr Raw kStop = 5;
  static constexpr canopen::ObjectAddress kSlowObject{0x2100, 1};
  using Sent = support::Spawned<Outcome>;

  Sent write_by(const Origin& from, std::vector<FieldWrite> fields) {
    return support::spawn(loop_.executor(), drive_->write(from, std::move(fields)));
  }
  Sent stop_by(Writer::Way way) { return write_by(origin(way), {field("control_command", kStop)}); }
  /// An SDO write of an object without a signal, as a parameter that goes to flash.
  Sent write_slow_object() {
    return support::spawn(loop_.executor(), drive_->sdo_write(origin(), {kSlowObject, DataType::u16, 1}));
  }
  /// Writes of it are answered that late, or not at all.
  void answer_slow_object(std::optional<Duration> after) {
    model_.commands.raw = true;
    slave_.set(kSlowObject, DataType::u16, 0);
    slave_.script([this, after](const Bytes& request) -> std::optional<std::vector<Bytes>> {
      if (request[1] != 0x00 || request[2] != 0x21) {
        return std::nullopt;
      }
      if (after) {
        slow_answer_at_ = canopen::Clock::now() + *after;
      }
      return std::vector<Bytes>{};
    });
  }
  /// Time passes until the control command is on the wire, by whichever way; at most `limit`.
  Duration until_on_wire(Duration limit) {
    Duration passed{};
    while (passed < limit && !control_on_wire()) {
      step();
      passed += std::chrono::milliseconds(1);
    }
    return passed;
  }
  void step() {
    run(std::chrono::milliseconds(1));
    if (slow_answer_at_ && canopen::Clock::now() >= *slow_answer_at_) {
      slow_answer_at_.reset();
      slave_.send(0x585, {0x60, 0x00, 0x21, 0x01, 0, 0, 0, 0});
      loop_.settle();
    }
  }
  [[nodiscard]] bool control_on_wire() const {
    const auto writes = sdo_writes();
    return !rpdos().empty() || std::find(writes.begin(), writes.end(), test::kControl) != writes.end();
  }
  void expect_stopped_beside_slow_write(Duration confirmed_within) {
    bring_online();
    show(test::kRunningBit);
    const Sent slow = write_slow_object();
    run(std::chrono::milliseconds(10));
    const Sent stop = stop_by(Writer::Way::mqtt);
    EXPECT_LE(until_on_wire(std::chrono::milliseconds(400)), std::chrono::milliseconds(150));
    for (Duration passed{}; passed < confirmed_within && !stop.done(); passed += std::chrono::milliseconds(1)) {
      step();
    }
    ASSERT_TRUE(stop.done());
    EXPECT_TRUE(stop.get().has_value()) << canopen::to_string(stop.get().error());
    ASSERT_TRUE(slow.done());
    ASSERT_TRUE(slow.get().has_error());
    EXPECT_TRUE(slow.get().error().outcome_unknown);
    EXPECT_EQ(slave_.value(test::kControl), kStop);
  }

  std::optional<canopen::TimePoint> slow_answer_at_;
};

}  // namespace process
