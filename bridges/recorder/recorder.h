#pragma once

#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "bridges/process/observer.h"
#include "bridges/process/plant.h"
#include "bridges/recorder/command_trail.h"
#include "bridges/recorder/frame_ring.h"
#include "bridges/recorder/quota.h"
#include "bridges/recorder/record.h"
#include "bridges/recorder/record_keeper.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/wake_up.h"
#include "config/model.h"

namespace recorder {

/// Keeps the frames of every bus in memory, and makes a record of those around a fault, or when asked to: a file of
/// frames and one of what happened. One of a bus at a time; faults that begin meanwhile are added to it. Each drive,
/// and each bus, has Quota::kMost of them an hour at most, and as many that were asked for.
class Recorder final : public process::Observer {
 public:
  struct Notices {
    std::function<void(const std::string&)> warning;
    std::function<void(const std::string&)> info;
  };

  /// `plant` outlives it and has a [recorder]. `may_still_hear`: a frame of that bus that came before this moment may
  /// still be delivered.
  Recorder(const boost::asio::any_io_executor& executor, process::Plant& plant, KeptAt at,
           std::function<bool(std::size_t bus, canopen::TimePoint until)> may_still_hear, Notices notices);

  /// Is to be shown every frame of that bus.
  [[nodiscard]] FrameRing& ring(std::size_t bus) noexcept { return lines_[bus]->ring; }
  /// From now on. An alarm that was told before is none that begins.
  void start();
  /// When the plant was stopped: ends what is under way, and waits for the disk for a second at most.
  boost::asio::awaitable<void> stop();

  struct Requested {
    std::string name;             ///< Of the log.
    bool was_under_way = false;   ///< It had begun before.
    canopen::Duration remaining;  ///< Until it ends.
  };
  /// Somebody wants a record now: of a drive, or of a whole bus. `user`: who. `refused` where there were too many.
  [[nodiscard]] canopen::Result<Requested> request(std::size_t bus, const std::string& drive, const std::string& user);

  /// Somebody found that a record is gone.
  void look_again() { keeper_.look(); }
  [[nodiscard]] const RecordKeeper& keeper() const noexcept { return keeper_; }

  void on_values(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) override {}
  void on_freshness(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) override {}
  void on_commanded(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) override {}
  void on_status(const process::Drive& /*drive*/) override {}
  void on_bus(std::size_t /*bus*/) override {}
  void on_command_done(const process::Drive& drive, const process::CommandRecord& record,
                       const process::Outcome& outcome) override;
  void on_alarm(const process::Drive& drive, alarms::AlarmKind kind) override;
  void on_bus_alarm(std::size_t bus) override;
  /// A record of a bus that left is ended. The rings of buses that are new are to be shown their frames.
  void on_plant_change(const process::PlantChange& change) override;

 private:
  /// What makes a begin of it.
  struct Activation {
    std::string id;
    bool fault = false;
  };
  struct UnderWay {
    Record record;
    canopen::TimePoint from;
    canopen::TimePoint until;
  };
  struct Line {
    Line(const boost::asio::any_io_executor& executor, canopen::Duration kept, std::size_t most,
         std::function<void(std::size_t bus)> on_end)
        : ring(kept, most), end(executor, [this, told = std::move(on_end)] { told(bus); }) {}
    FrameRing ring;
    std::size_t bus = 0;  ///< Its position.
    CommandTrail commands;
    std::optional<UnderWay> under_way;
    canopen::WakeUp end;
    Activation alarm;  ///< Of the bus.
  };
  using OfDrive = std::array<Activation, alarms::kAlarmKinds.size()>;

  [[nodiscard]] std::unique_ptr<Line> make_line(std::size_t bus);
  [[nodiscard]] static Activation activation(const alarms::Alarm& alarm);
  void hand_over();
  /// It changed, and a fault of it begins now.
  [[nodiscard]] bool begins(const alarms::Alarm& alarm, Activation& before) const;
  void note(std::size_t bus, RecordedAlarm now, bool is_begin);
  [[nodiscard]] bool is_allowed(const std::string& subject, bool requested);
  UnderWay& begin(std::size_t bus, RecordName name);
  void on_end(std::size_t bus);
  void finish(std::size_t bus, std::string ended);
  void on_kept(const Record& record);
  /// Alarms name no record that is gone.
  void forget_removed();
  void set_record(const std::string& bus, const RecordedAlarm& alarm, const std::string& name);

  boost::asio::any_io_executor executor_;
  process::Plant& plant_;
  config::Recorder settings_;
  std::function<bool(std::size_t bus, canopen::TimePoint until)> may_still_hear_;
  Notices notices_;
  std::vector<std::unique_ptr<Line>> lines_;  ///< Of the buses.
  std::vector<OfDrive> drives_;
  std::set<std::string> handed_over_;  ///< Ids of the faults that were active when the plant last changed.
  Quota quota_;
  RecordKeeper keeper_;
  bool started_ = false;
};

}  // namespace recorder
