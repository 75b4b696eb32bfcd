#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "canopen/bus/bus_load.h"
#include "canopen/clock.h"
#include "canopen/wake_up.h"

namespace canopen {

/// What all SDO transfers of one bus may take together: how many run at once, and which load they lead to. SDO goes
/// before heartbeats on the wire, whoever sends them (CiA 301 table 75): without a limit the boots of many drives
/// starve them all. Where the bit rate is not known only the number is limited.
///
/// Commands do not ask, they only count (charge()).
class SdoBudget {
 public:
  /// A place for one transfer, asked for when it begins to exist and given back when it goes. A granted place counts
  /// only as long as an answer may be expected soon: a silent drive must not keep others from their turn.
  class Claim {
   public:
    /// Of those who wait the one with the earliest `due` is next, of equal ones the older. `on_granted` is called where
    /// the place was not granted at once; it must not destroy a claim. The budget outlives the claim.
    Claim(SdoBudget& budget, TimePoint due, std::function<void()> on_granted);
    ~Claim();
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;

    [[nodiscard]] bool granted() const noexcept { return granted_; }

   private:
    friend class SdoBudget;
    SdoBudget& budget_;
    TimePoint due_;
    std::function<void()> on_granted_;
    bool granted_ = false;
    TimePoint counts_until_{};
  };

  /// `most_load`: what all traffic together may reach for the sake of SDO, 0..1; SDO may take a tenth in any case.
  /// `load` is fed by the bus and outlives the budget.
  SdoBudget(const boost::asio::any_io_executor& executor, std::optional<std::uint32_t> bitrate, double most_load,
            BusLoad& load);
  SdoBudget(const SdoBudget&) = delete;
  SdoBudget& operator=(const SdoBudget&) = delete;
  ~SdoBudget() = default;

  /// The interface told it.
  void set_bitrate(std::uint32_t bitrate);
  /// Frames of eight bytes that nobody claimed a place for: a request and its answer, or what else comes at once.
  void charge(unsigned frames = 2);
  /// When the traffic so far will have had its time: who has many frames to come waits until then.
  [[nodiscard]] TimePoint free_at() const noexcept { return paid_until_ - kAhead; }
  [[nodiscard]] std::size_t most_at_once() const noexcept { return most_at_once_; }

  static constexpr double kUsualLoad = 0.7;
  static constexpr double kLeastShare = 0.1;
  static constexpr std::size_t kAtOnceWithoutBitrate = 8;
  /// So much may be granted ahead, for timers are not exact.
  static constexpr Duration kAhead = std::chrono::milliseconds(5);

 private:
  void add(Claim& claim);
  void remove(Claim& claim);
  [[nodiscard]] bool may_grant(TimePoint now);
  void grant_next(TimePoint now);
  void grant_what_may_be();
  void arm();
  [[nodiscard]] Duration time_of(unsigned frames, TimePoint now);

  std::optional<std::uint32_t> bitrate_;
  double most_load_;
  BusLoad& load_;
  std::size_t most_at_once_ = kAtOnceWithoutBitrate;
  Duration answer_time_;         ///< How long a granted place counts.
  std::vector<Claim*> waiting_;  ///< The next one first.
  std::vector<Claim*> granted_;  ///< Those that count, in the order they were granted.
  TimePoint paid_until_{};       ///< When the traffic granted so far will have had its time.
  WakeUp wake_up_;
};

}  // namespace canopen
