#pragma once

#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "canopen/bus/bus_state.h"
#include "canopen/bus/frame_tap.h"
#include "canopen/bus/subscription.h"
#include "canopen/survey/burst_meter.h"
#include "canopen/survey/bus_health.h"
#include "canopen/survey/day_extremes.h"
#include "canopen/survey/node_table.h"
#include "canopen/survey/period_table.h"
#include "canopen/survey/recent_traffic.h"
#include "canopen/survey/suspicion_hold.h"
#include "canopen/wake_up.h"

namespace canopen {

class Bus;

/// Keeps what tells how sound a bus is, by what is heard anyway: it sends nothing. A frame costs it some nanoseconds,
/// and memory only where its COB-ID is new.
class BusSurvey final : private FrameTap {
 public:
  /// What others know of the bus.
  struct Known {
    NodeSet served{};  ///< Nodes that are online.
    BusTroubles troubles{};
    std::optional<DoubledSign> doubled{};
  };
  struct Handlers {
    std::function<Known()> known;  ///< Asked each second.
    /// `displaced`: in whose place.
    std::function<void(const Suspicion& began, const std::optional<Suspicion>& displaced)> began{};
    std::function<void(const Suspicion&)> ended{};  ///< No sign of it any more, or the interface is down.
  };

  /// `bus` outlives the survey, and calls it from before start() on.
  BusSurvey(const boost::asio::any_io_executor& executor, Bus& bus, Handlers handlers);
  BusSurvey(const BusSurvey&) = delete;
  BusSurvey& operator=(const BusSurvey&) = delete;
  ~BusSurvey() = default;

  /// Silence of this node that means loss.
  void set_timeout(std::uint8_t node, Duration timeout) { nodes_.set_timeout(node, timeout); }
  void start();
  void stop() { timer_.cancel(); }

  [[nodiscard]] BusHealth health() const;
  // Parts of it.
  [[nodiscard]] const std::optional<Suspicion>& suspicion() const noexcept { return suspicion_.standing(); }
  [[nodiscard]] std::optional<Burst> burst() const noexcept { return bursts_.of_day(hour_); }
  [[nodiscard]] NodeHealth node(std::uint8_t node) const { return nodes_.of_day(node, hour_); }
  /// Of each COB-ID.
  [[nodiscard]] std::vector<PeriodHealth> periods() const { return periods_.of_day(hour_); }

 private:
  void on_frame(const Received& frame, FrameOrigin origin) override;
  void on_frames_lost(std::uint32_t count) override;
  void on_state(const BusState& state);
  /// What disturbed until now had a reason of its own: nothing was readable, or the interface was another.
  void forget_disturbances() noexcept;
  /// Each second.
  void look();
  void set_served(const NodeSet& served);
  void keep_figures();
  [[nodiscard]] Signs signs(const Known& known) const;
  [[nodiscard]] std::string busiest() const;

  Bus& bus_;
  Handlers handlers_;
  PeriodTable periods_;
  NodeTable nodes_;
  BurstMeter bursts_;
  RecentTraffic traffic_;
  TimePoint second_began_{};  ///< The current one of `traffic_`.
  DayExtremes load_;
  DayExtremes transmit_errors_;
  DayExtremes receive_errors_;
  DayExtremes errors_;
  SuspicionHold suspicion_;
  BusState state_;
  NodeSet served_;
  std::uint32_t hour_;
  std::uint32_t unbroken_ = 1;
  bool heard_ = false;  ///< Since the interface came up, or the gateway opened it.
  bool saw_it_go_down_ = false;
  bool saw_it_come_up_ = false;
  std::array<TimePoint, kExcursions> excursions_;  ///< When the controller left error-active, newest first.
  /// It left error-active then and is not back, and no missing acknowledgement explains that.
  std::optional<TimePoint> unwell_since_;
  std::array<TimePoint, 2> bus_offs_;
  WakeUp timer_;
  std::vector<Subscription> subscriptions_;
};

}  // namespace canopen
