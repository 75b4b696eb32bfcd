#pragma once

#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <span>
#include <string>
#include <vector>

#include "bridges/alarms/alarm_keeper.h"
#include "bridges/process/observer.h"
#include "bridges/process/plant.h"
#include "config/model.h"

namespace gateway {

/// Keeps the alarms of the plant over a restart, in the state directory.
class KeptAlarms final : public process::Observer {
 public:
  /// `plant` outlives it. There is a state directory.
  KeptAlarms(const boost::asio::any_io_executor& executor, process::Plant& plant);

  /// Before the plant starts: its alarms become what they were. What is not configured any more is dropped.
  void restore();
  /// When the plant was stopped.
  boost::asio::awaitable<void> stop() { return keeper_.stop(); }

  void on_values(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) override {}
  void on_freshness(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) override {}
  void on_commanded(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) override {}
  void on_status(const process::Drive& /*drive*/) override {}
  void on_bus(std::size_t /*bus*/) override {}
  void on_alarm(const process::Drive& drive, alarms::AlarmKind kind) override;
  void on_bus_alarm(std::size_t bus) override;
  /// What is not configured any more is forgotten.
  void on_plant_change(const process::PlantChange& change) override;

 private:
  /// What makes a begin or an end of it.
  struct Activation {
    bool active = false;
    std::string id;
    friend bool operator==(const Activation&, const Activation&) = default;
  };
  using OfDrive = std::array<Activation, alarms::kAlarmKinds.size()>;

  void restore_first(const alarms::NamedFault& first);
  [[nodiscard]] alarms::AlarmMemory snapshot() const;
  void note(const alarms::Alarm& alarm, Activation& before);

  process::Plant& plant_;
  alarms::AlarmKeeper keeper_;
  std::vector<OfDrive> drives_;
  std::vector<Activation> buses_;
  bool restored_ = false;  ///< What is told before is from the file itself.
};

}  // namespace gateway
