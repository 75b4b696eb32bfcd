#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "canopen/clock.h"

namespace alarms {

/// Whose alarm a fault belongs to.
struct FaultSource {
  bool bus = false;       ///< Of a bus; else of a drive.
  std::size_t index = 0;  ///< Position in config::Model::buses, or in config::Model::drives.
  AlarmKind kind{};       ///< Of no meaning for a bus: leave it.
  friend auto operator<=>(const FaultSource&, const FaultSource&) = default;
};

/// Which fault came first, over all drives and buses: one that no other fault came before within 2 s. Faults that
/// follow each other at no more than that are a group, which has one first. Of equal times the one that was told
/// first is first.
///
/// Frames of two buses may be handled in another order than they came: an earlier fault that is told later takes the
/// flag from the one that had it, and one that closes the gap between two groups takes it from the first of the later.
/// A source that is first of its group and trips again within it stays first: its own fault before is no other's.
/// Warnings are not told to it.
class FirstOut {
 public:
  static constexpr canopen::Duration kWindow = std::chrono::seconds(2);
  /// Groups that a late frame may still change: they span two minutes at least.
  static constexpr std::size_t kMaxGroups = 64;
  /// `first` of an alarm's present activation is another now. Not called for what on_fault() was told it is.
  using Changed = std::function<void(const FaultSource& source, bool first)>;

  explicit FirstOut(Changed changed);

  /// A fault became active at `at`: an alarm, or one more error in an active one. `first`: what the alarm shows now,
  /// false where its activation has just begun.
  void on_fault(const FaultSource& source, canopen::TimePoint at, bool first);
  /// The first of the newest group; nothing: no fault yet.
  [[nodiscard]] std::optional<FaultSource> newest_group() const;
  /// The first of the newest group before the gateway's start: holds until a group begins. Ignored after a fault.
  void restore(const FaultSource& newest);
  /// Drives and buses have other positions. `now_at`: where a source is now; nothing: it is gone, and with it the
  /// groups that it was the first of. No flag changes by that.
  void move(const std::function<std::optional<FaultSource>(const FaultSource&)>& now_at);

 private:
  struct Group {
    FaultSource first;
    std::uint32_t activation = 0;  ///< Of the first.
    canopen::TimePoint begin;
    canopen::TimePoint end;  ///< Of its latest fault.
  };
  struct Shown {
    std::uint32_t activation = 0;  ///< Counts those that were told.
    std::uint32_t firsts = 0;      ///< Groups that the present one is first of.
    bool told = false;
    canopen::TimePoint begun{};  ///< Of the present activation.
  };

  using Groups = std::vector<Group>;

  void begin_group(Groups::iterator before, const FaultSource& source, canopen::TimePoint at);
  void join(Groups::iterator group, const FaultSource& source, canopen::TimePoint at);
  void give(Group& group, const FaultSource& source);
  void take(const Group& group);
  /// The present activation of its first, where that began within it.
  void renew(Group& group);
  void tell(const FaultSource& source);

  Changed changed_;
  Groups groups_;  ///< In order of time, more than kWindow between them.
  std::map<FaultSource, Shown> shown_;
  std::optional<FaultSource> restored_;
  bool full_ = false;  ///< Groups were forgotten.
};

}  // namespace alarms
