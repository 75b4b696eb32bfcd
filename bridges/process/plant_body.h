#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "bridges/alarms/alarm_record.h"
#include "bridges/alarms/bus_findings.h"
#include "bridges/alarms/first_out.h"
#include "bridges/process/plant.h"
#include "bridges/process/plant_change.h"

// Of the plant's own files alone.

namespace process {

class Plant::Body {
 public:
  struct Line {
    BusPort port;
    canopen::BusState state{};
    canopen::BusTroubles troubles{};
    alarms::AlarmRecord alarm{};
    bool told = false;  ///< The bus told its state.
  };
  /// A drive, and the model that it was made of, which lives as long.
  struct Place {
    std::shared_ptr<const config::Model> model;
    std::unique_ptr<Drive> drive;
  };

  Body(const boost::asio::any_io_executor& for_drives, std::shared_ptr<const config::Model> plant_model,
       std::vector<BusPort> buses);

  [[nodiscard]] Place make_drive(std::size_t index);
  /// Alarms of what has another configuration under the same name, by positions of now.
  struct Inherited {
    std::vector<std::pair<std::size_t, alarms::Alarm>> of_buses;
    std::vector<std::tuple<std::size_t, alarms::AlarmKind, alarms::Alarm>> of_drives;
  };
  /// Before anything is where it is in the new model. A flag of an alarm goes with the name, too.
  [[nodiscard]] Inherited inherit(const config::Model& before, const PlantChange& from);
  /// Drives that stay are where they are in the model now, new ones are made, the others are among those that left.
  void replace_drives(const PlantChange& from);
  [[nodiscard]] Drive* find(std::string_view name) const noexcept;
  [[nodiscard]] std::vector<alarms::BusFinding> findings(std::size_t bus) const;
  void show(std::size_t bus);
  void set_first(const alarms::FaultSource& source, bool first);
  void tell_bus_alarm(std::size_t bus) const;

  boost::asio::any_io_executor executor;
  std::shared_ptr<const config::Model> model;
  CommandJournal* journal = nullptr;
  bool other_gateway = false;
  std::uint64_t changes = 0;
  std::vector<Observer*> observers;
  std::vector<Line> lines;
  std::vector<Place> drives;
  std::vector<Place> left;  ///< Stopped; somebody may still have a pointer to one.
  alarms::FirstOut first_out{[this](const alarms::FaultSource& source, bool first) { set_first(source, first); }};
  std::optional<std::size_t> telling_bus;  ///< Its alarm is told of as soon as its flag is known.
};

}  // namespace process
