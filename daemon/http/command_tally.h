#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>

#include "bridges/process/command_journal.h"
#include "bridges/process/observer.h"
#include "canopen/clock.h"

namespace gateway::http {

/// Counts what became of commands, by drive and by way.
class CommandTally final : public process::Observer {
 public:
  using Way = process::Writer::Way;
  /// Upper bounds of what a confirmation took; what took longer is in none.
  static constexpr std::array<canopen::Duration, 10> kBounds{
      std::chrono::milliseconds(5),   std::chrono::milliseconds(10),  std::chrono::milliseconds(20),
      std::chrono::milliseconds(50),  std::chrono::milliseconds(100), std::chrono::milliseconds(200),
      std::chrono::milliseconds(500), std::chrono::seconds(1),        std::chrono::seconds(2),
      std::chrono::seconds(5)};

  struct Tally {
    std::map<std::string_view, std::uint64_t> outcomes;  ///< `ok`, or the code of the answer.
    std::array<std::uint64_t, kBounds.size()> within{};  ///< Confirmed, each in its narrowest bound only.
    std::uint64_t confirmed = 0;
    canopen::Duration took{};  ///< All confirmed together.
  };
  /// Position of the drive, and the way.
  using Tallies = std::map<std::pair<std::size_t, Way>, Tally>;

  [[nodiscard]] const Tallies& tallies() const noexcept { return tallies_; }

  void on_values(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_freshness(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_commanded(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_command_done(const process::Drive& drive, const process::CommandRecord& record,
                       const process::Outcome& outcome) override;
  void on_status(const process::Drive& drive) override;
  void on_alarm(const process::Drive& drive, alarms::AlarmKind kind) override;
  void on_bus(std::size_t bus) override;
  /// The counts of a drive that stays go on, those of others end.
  void on_plant_change(const process::PlantChange& change) override;

 private:
  Tallies tallies_;
};

}  // namespace gateway::http
