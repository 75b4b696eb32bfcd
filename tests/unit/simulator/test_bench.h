#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "canopen/bus/link.h"
#include "canopen/bus/virtual_link.h"
#include "canopen/frame.h"
#include "simulator/drive.h"
#include "simulator/network.h"
#include "tests/support/hand_driven_loop.h"

namespace simulator {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A data frame from its bytes.
inline canopen::Frame frame(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  return canopen::make_frame(id, std::span(bytes.begin(), bytes.size()));
}

inline std::uint16_t word_at(const canopen::Frame& frame, std::size_t position) {
  return static_cast<std::uint16_t>(frame.data[position] | (frame.data[position + 1] << 8U));
}

/// Simulated drives on a bus and a master that knows nothing but frames.
class Bench : public canopen::LinkEvents {
 public:
  Bench() {
    network.open();
    master_->open(*this);
    loop.settle();
  }
  virtual ~Bench() { master_->close(); }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  /// Leaves with the next settle().
  void queue(const canopen::Frame& sent) { ASSERT_EQ(master_->send(sent), canopen::SendResult::handed_over); }
  void send(const canopen::Frame& sent) {
    queue(sent);
    loop.settle();
  }
  void send(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) { send(frame(id, bytes)); }
  void remote_request(std::uint32_t id) {
    canopen::Frame request;
    request.id = id;
    request.remote = true;
    send(request);
  }
  void nmt(std::uint8_t command, std::uint8_t node) { send(0, {command, node}); }
  void advance(canopen::Duration by) { loop.advance(by); }

  /// What the drives have sent with this COB-ID since the last call.
  std::vector<canopen::Frame> take(std::uint32_t id) {
    std::vector<canopen::Frame> taken;
    std::erase_if(heard, [&](const canopen::Frame& candidate) {
      if (candidate.id == id) {
        taken.push_back(candidate);
      }
      return candidate.id == id;
    });
    return taken;
  }
  /// The latest of them.
  std::optional<canopen::Frame> last(std::uint32_t id) {
    const auto taken = take(id);
    return taken.empty() ? std::nullopt : std::optional(taken.back());
  }

  /// The one answer to an SDO request; nothing when there is none or more than one.
  std::optional<canopen::Frame> sdo(std::uint8_t node, std::initializer_list<std::uint8_t> request) {
    take(0x580U + node);
    send(0x600U + node, request);
    const auto answers = take(0x580U + node);
    return answers.size() == 1 ? std::optional(answers[0]) : std::nullopt;
  }
  /// The number an expedited upload gives; nothing when it is refused.
  std::optional<std::uint32_t> read(std::uint8_t node, std::uint16_t index, std::uint8_t sub) {
    const auto answer = sdo(node, {0x40, low(index), high(index), sub, 0, 0, 0, 0});
    if (!answer || (answer->data[0] & 0xE3U) != 0x43) {
      return std::nullopt;
    }
    std::uint32_t value = 0;
    for (unsigned i = 0; i < 4U - ((answer->data[0] >> 2U) & 3U); ++i) {
      value |= static_cast<std::uint32_t>(answer->data[4 + i]) << (8 * i);
    }
    return value;
  }
  /// 0 when the drive took it, else its abort code; 1 without a usable answer.
  std::uint32_t write(std::uint8_t node, std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned size) {
    const auto answer = sdo(node, {static_cast<std::uint8_t>(0x23U | ((4U - size) << 2U)), low(index), high(index), sub,
                                   byte(value, 0), byte(value, 1), byte(value, 2), byte(value, 3)});
    return outcome(answer);
  }
  std::uint32_t read_abort(std::uint8_t node, std::uint16_t index, std::uint8_t sub) {
    return outcome(sdo(node, {0x40, low(index), high(index), sub, 0, 0, 0, 0}));
  }

  support::HandDrivenLoop loop;
  canopen::VirtualBus bus{loop.executor()};
  Network network{loop.executor(), bus.connect()};
  std::vector<canopen::Frame> heard;

  void on_frames(std::span<const canopen::Received> frames) override {
    for (const canopen::Received& received : frames) {
      heard.push_back(received.frame);
    }
  }
  void on_echo(const canopen::Received&) override {}
  void on_bus_state(const canopen::BusState& /*state*/) override {}
  void on_frames_lost(std::uint32_t /*count*/) override {}

 private:
  static std::uint8_t low(std::uint16_t value) { return static_cast<std::uint8_t>(value); }
  static std::uint8_t high(std::uint16_t value) { return static_cast<std::uint8_t>(value >> 8U); }
  static std::uint8_t byte(std::uint32_t value, unsigned position) {
    return static_cast<std::uint8_t>(value >> (8 * position));
  }
  static std::uint32_t outcome(const std::optional<canopen::Frame>& answer) {
    if (!answer) {
      return 1;
    }
    if (answer->data[0] != 0x80) {
      return 0;
    }
    return static_cast<std::uint32_t>(answer->data[4]) | (static_cast<std::uint32_t>(answer->data[5]) << 8U) |
           (static_cast<std::uint32_t>(answer->data[6]) << 16U) | (static_cast<std::uint32_t>(answer->data[7]) << 24U);
  }

  std::unique_ptr<canopen::Link> master_ = bus.connect();
};

/// A bench with one drive, powered and past its boot-up.
class OneDrive : public Bench {
 public:
  OneDrive(std::string_view kind, std::uint8_t node, const DriveOptions& options = {})
      : drive_(make_drive(kind, node, network, options)) {
    drive_->power_on();
    loop.settle();
    heard.clear();
  }
  Drive& drive() { return *drive_; }
  void start() { nmt(0x01, drive_->node()); }

 private:
  std::unique_ptr<Drive> drive_;
};

}  // namespace simulator
