#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "canopen/node/remote_node.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/unit/canopen/scale_drive.h"

namespace canopen {

/// What a remote node told of its troubles.
class TroubleCount final : public NodeEvents {
 public:
  void on_status(const NodeStatus& status) override;
  void on_boot_up() override {}
  void on_arrival(Arrival) override {}
  void on_tpdo(std::uint16_t, std::span<const Raw>, TimePoint, WallTime) override {}
  void on_tpdo_length(std::uint16_t, std::size_t, std::size_t) override {}
  void on_emcy(const Emcy&, TimePoint, WallTime) override {}
  void on_frames_lost() override {}

  std::size_t letters = 0;  ///< Boots that ended with one.
  std::size_t losses = 0;
  std::string text;  ///< Of the newest letter.

 private:
  BootResult letter_ = BootResult::not_booted;
  bool lost_ = false;
};

/// Hears every frame on the bus, and how far apart heartbeats are.
class HeartbeatEar final : public LinkEvents {
 public:
  explicit HeartbeatEar(VirtualBus& bus) : link_(bus.connect()) { link_->open(*this); }
  void on_frames(std::span<const Received> frames) override;
  void on_echo(const Received&) override {}
  void on_bus_state(const BusState&) override {}
  void on_frames_lost(std::uint32_t) override {}

  [[nodiscard]] Duration longest_gap(std::uint8_t node) const noexcept { return gaps_[node].longest; }
  [[nodiscard]] std::size_t frames() const noexcept { return frames_; }
  /// Bits on the bus since the bench began.
  [[nodiscard]] std::uint64_t bits() const noexcept { return bits_; }

 private:
  struct Gap {
    std::optional<TimePoint> last;
    Duration longest{};
  };
  std::unique_ptr<Link> link_;
  std::array<Gap, 128> gaps_{};
  std::size_t frames_ = 0;
  std::uint64_t bits_ = 0;
};

/// Many drives and their master on a bus with a bit rate, moved from event to event by hand. Several of them may share
/// a loop; who has it calls act() of each.
class ScaleBench {
 public:
  static constexpr std::uint8_t kOwnNode = 127;

  /// `tpdo_event_timer` in ms, 0: no TPDOs. `bitrate_known`: the master was told the bit rate.
  explicit ScaleBench(std::uint32_t bitrate, std::uint16_t tpdo_event_timer = 0, bool bitrate_known = true);
  /// `loop` outlives the bench.
  ScaleBench(support::HandDrivenLoop& loop, std::uint32_t bitrate);
  ~ScaleBench();
  ScaleBench(const ScaleBench&) = delete;
  ScaleBench& operator=(const ScaleBench&) = delete;

  struct Member {
    std::unique_ptr<ScaleDrive> drive;
    TroubleCount troubles;
    std::unique_ptr<RemoteNode> node;

    [[nodiscard]] bool online() const { return node->status().online && node->status().nmt == NmtState::operational; }
  };

  /// `sdo.patience` of the drives that are added from now on.
  void set_patience(Duration patience) { patience_ = patience; }
  /// A drive that is off, and its master.
  Member& add(std::uint8_t node);
  /// Moves time on until `done`; false where `limit` passed first.
  template <class Predicate>
  [[nodiscard]] bool run_until(Predicate done, Duration limit) {
    const TimePoint end = Clock::now() + limit;
    while (!done()) {
      if (Clock::now() >= end) {
        return false;
      }
      step(end);
    }
    return true;
  }
  void run_for(Duration time) {
    static_cast<void>(run_until([] { return false; }, time));
  }
  /// What is due now; when to come back, at the latest at `end`.
  [[nodiscard]] TimePoint act(TimePoint end);
  [[nodiscard]] bool all_online() const;
  [[nodiscard]] std::size_t letters() const;
  [[nodiscard]] std::size_t losses() const;
  [[nodiscard]] std::string a_letter() const;

  [[nodiscard]] const HeartbeatEar& ear() const noexcept { return ear_; }
  [[nodiscard]] Bus& bus() noexcept { return bus_; }
  [[nodiscard]] boost::asio::any_io_executor executor() { return loop_.executor(); }
  [[nodiscard]] std::vector<std::unique_ptr<Member>>& members() noexcept { return members_; }

 private:
  ScaleBench(support::HandDrivenLoop* loop, std::uint32_t bitrate, std::uint16_t tpdo_event_timer, bool bitrate_known);
  void step(TimePoint end);
  [[nodiscard]] NodeSettings settings_of(std::uint8_t node) const;

  std::unique_ptr<support::HandDrivenLoop> own_loop_;
  support::HandDrivenLoop& loop_;
  VirtualBus wire_;
  Bus bus_;
  HeartbeatEar ear_;
  std::uint16_t tpdo_event_timer_;
  Duration patience_{};
  std::vector<std::unique_ptr<Member>> members_;
};

}  // namespace canopen
