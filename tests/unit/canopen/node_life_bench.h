#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/canopen/node_bench.h"

namespace canopen {

constexpr ObjectAddress kStatusWord{0x6041, 0};
/// The second field of the TPDO of bench_settings(), and what it maps where somebody else set it up.
constexpr ObjectAddress kMapping{0x1A00, 2};
constexpr Raw kWantedMapping = 0x60440010;
constexpr Raw kOtherMapping = 0x60430010;
/// The event timer of the same TPDO; a drive takes it while operational, too.
constexpr ObjectAddress kTpdoEventTimer{0x1800, 5};
/// What is read last before the NMT start of a boot that finds everything as wanted.
constexpr ObjectAddress kLastRead{0x1014, 0};

/// With the objects of a CiA 402 drive that tell whether its motor may be started.
inline NodeSettings with_motor() {
  NodeSettings settings = bench_settings();
  settings.motor.running = kRunning;
  settings.motor.fault = MotorSign{kStatusWord, DataType::u16, 8, {8}};
  settings.motor.control = kControlWord;
  settings.motor.stops = {{0xF882, 0}, {0xF884, 0}, {0xF887, 6}};
  return settings;
}

/// Without heartbeat, asked each `period` whether it lives.
inline NodeSettings guarded_each(Duration period) {
  NodeSettings settings = with_motor();
  settings.error_control.heartbeat = Duration::zero();
  settings.error_control.guarding = period;
  settings.error_control.has_guarding = true;
  return settings;
}

/// A node that others act on, too: its own panel, another master, the one who switches it off.
class NodeLifeBench : public NodeCommandBench {
 protected:
  using Bytes = support::ScriptedSlave::Bytes;
  using Answers = std::optional<std::vector<Bytes>>;

  ~NodeLifeBench() override { closed_ = false; }  // A test that failed half-way still ends.

  /// It goes to `state` by itself, and its heartbeat says so at once.
  void says(std::uint8_t state) {
    slave_.set_state(state);
    slave_.send(0x705, {state});
    loop_.advance(std::chrono::milliseconds(1));
  }
  /// Switch on disabled, and a shutdown in its control word: nothing speaks against a start.
  void motor_stands() {
    slave_.set(kStatusWord, DataType::u16, 0x0650);
    slave_.set(kControlWord, DataType::u16, 0x0006);
  }
  /// As CiA 301 has it: a stopped node answers no SDO.
  void silent_when_stopped() {
    slave_.script([this](const Bytes&) { return slave_.state() == 4 ? Answers(std::vector<Bytes>{}) : std::nullopt; });
  }
  /// As CiA 402 devices do: PDO settings only while pre-operational.
  [[nodiscard]] Answers refused_while_operational(const Bytes& request) const {
    const bool write = (request[0] & 0xE0U) == 0x20;
    const bool of_pdo = request[2] >= 0x14 && request[2] < 0x1C;
    if (!write || !of_pdo || slave_.state() != 5) {
      return std::nullopt;
    }
    return std::vector<Bytes>{{0x80, request[1], request[2], request[3], 0x22, 0, 0, 0x08}};
  }
  static bool reads(const Bytes& request, ObjectAddress object) {
    return request == Bytes{0x40,
                            static_cast<std::uint8_t>(object.index & 0xFFU),
                            static_cast<std::uint8_t>(object.index >> 8U),
                            object.sub,
                            0,
                            0,
                            0,
                            0};
  }
  /// `act` happens when the read of `object` has come to the drive, and before its answer.
  void when_read(ObjectAddress object, std::function<void()> act) {
    slave_.script([object, act = std::move(act)](const Bytes& request) -> Answers {
      if (reads(request, object)) {
        act();
      }
      return std::nullopt;
    });
  }
  /// Our NMT start of the boot has left.
  [[nodiscard]] bool wait_nmt(Duration limit = std::chrono::seconds(2)) {
    return loop_.advance_until([this] { return !nmt_heard().empty(); }, limit);
  }
  /// A node of these settings boots, and its NMT start waits to leave on a bus that takes nothing of ours.
  void hold_its_start(const NodeSettings& settings) {
    install(settings);
    when_read(kLastRead, [this] { closed_ = true; });
    start(settings);
    slave_.boot_up();
    ASSERT_TRUE(loop_.advance_until([this] { return status().configured; }, std::chrono::seconds(2)));
    slave_.script({});
  }
  /// It leaves operational by itself.
  void leave_operational() {
    slave_.forget_heard();
    says(127);
    ASSERT_EQ(status().boot_result, BootResult::not_configured);
  }
  [[nodiscard]] long starts() const {
    const std::vector<Frame> heard = nmt_heard();
    return std::count(heard.begin(), heard.end(), nmt(1));
  }
  /// Not started, and not written to.
  void expect_let_be() const {
    EXPECT_TRUE(nmt_heard().empty());
    EXPECT_TRUE(slave_.writes().empty());
  }
  [[nodiscard]] bool told(const std::string& part) const { return status().boot_text.find(part) != std::string::npos; }
};

}  // namespace canopen
