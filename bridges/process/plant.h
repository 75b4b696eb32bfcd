#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/alarms/first_out.h"
#include "bridges/process/drive.h"
#include "canopen/bus/bus_state.h"
#include "config/model.h"

namespace process {

struct PlantChange;

struct ActiveAlarm {
  const Drive* drive = nullptr;  ///< Null: it is of a bus.
  std::size_t bus = 0;           ///< Of a bus: position in config::Model::buses.
  alarms::AlarmKind kind{};      ///< Of a drive.
  const alarms::Alarm* alarm = nullptr;
};

/// All drives and buses of the gateway.
class Plant {
 public:
  struct BusPort {
    canopen::Bus* bus = nullptr;  ///< Outlives the plant.
    std::function<canopen::BusStatistics()> statistics;
  };

  /// `buses` stand in the order of model.buses. The model lives as long as anything was made of it.
  Plant(const boost::asio::any_io_executor& executor, std::shared_ptr<const config::Model> model,
        std::vector<BusPort> buses);
  /// The same with a model that outlives the plant.
  Plant(const boost::asio::any_io_executor& executor, const config::Model& model, std::vector<BusPort> buses);
  ~Plant();
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  /// Before start(), or while nobody is told anything; observers outlive the plant or its stop(), or are removed.
  void add(Observer& observer);
  void remove(Observer& observer);
  /// Of all drives, see Drive::set_journal(). Before start().
  void set_journal(CommandJournal* journal);
  void start();
  /// The end is near, see Drive::close(). Before stop().
  void close();
  boost::asio::awaitable<void> stop();

  /// The configuration changes while the plant runs: first those drives are stopped, by their positions, which goes on
  /// for some turns of the loop; all others do not notice. Commands to them are answered `offline`.
  boost::asio::awaitable<void> stop(std::vector<std::size_t> drives);
  /// Then, at once, `model` is the plant's. `from` tells which drives and buses are the same ones: those stay as they
  /// are; all others that were there are stopped. `buses` in the order of the new model. New drives are made and begin
  /// as after a start of the gateway; one that has the name of one that left has its alarms, as over a restart. So has
  /// a bus. All observers are told before any drive begins.
  void change(std::shared_ptr<const config::Model> model, std::vector<BusPort> buses, const PlantChange& from);
  /// Drives that left are kept, stopped, until this is called: who waited for an answer of one may still look at it.
  /// Before their buses go.
  void forget_left();
  /// Grows with each change: who goes over drives or buses by their positions, in pieces, sees that these are others.
  [[nodiscard]] std::uint64_t changes() const noexcept;

  /// Of now: it is another one after a change().
  [[nodiscard]] const config::Model& model() const noexcept;
  [[nodiscard]] const std::shared_ptr<const config::Model>& shared_model() const noexcept;
  [[nodiscard]] std::size_t size() const noexcept;  ///< Drives.
  [[nodiscard]] Drive& drive(std::size_t index) noexcept;
  [[nodiscard]] const Drive& drive(std::size_t index) const noexcept;
  /// Null where no drive has this name.
  [[nodiscard]] Drive* find(std::string_view name) noexcept;
  [[nodiscard]] const Drive* find(std::string_view name) const noexcept;
  [[nodiscard]] std::size_t online() const noexcept;
  [[nodiscard]] std::size_t with_alarm() const noexcept;  ///< Drives with any active alarm.

  /// As it was before our start, until the bus tells its state. Before start().
  void restore_bus_alarm(std::size_t bus, const alarms::Alarm& before);
  /// The bus told so; drives hear it from the bus itself.
  void set_bus_state(std::size_t bus, const canopen::BusState& state);
  /// What was found wrong with the bus beside its state.
  void set_bus_troubles(std::size_t bus, const canopen::BusTroubles& troubles);
  /// Another gateway of our name lives, or does so no more: a warning of each bus.
  void set_other_gateway(bool lives);
  /// Alarm::record of its alarm.
  void set_bus_record(std::size_t bus, std::string name);
  [[nodiscard]] const canopen::BusState& bus_state(std::size_t bus) const noexcept;
  [[nodiscard]] canopen::BusStatistics bus_statistics(std::size_t bus) const;
  [[nodiscard]] const alarms::Alarm& bus_alarm(std::size_t bus) const noexcept;

  /// Whose fault was the first of the newest group (alarms::FirstOut): register 1016. Nothing: no fault yet.
  [[nodiscard]] std::optional<alarms::FaultSource> first_out() const;
  /// As it was before our start. Before start().
  void restore_first_out(const alarms::FaultSource& newest);

  /// All that are known and active, oldest first; those of one moment in the order of drives, kinds, buses. The
  /// pointers hold until the next change of an alarm.
  [[nodiscard]] std::vector<ActiveAlarm> active_alarms() const;

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

}  // namespace process
