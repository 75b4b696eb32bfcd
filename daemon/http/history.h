#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bridges/process/observer.h"
#include "bridges/process/plant.h"
#include "canopen/clock.h"
#include "daemon/http/answer.h"

namespace gateway::http {

/// The values of the last ten minutes, a sample each second: for trend lines. Added to the plant's observers.
class History final : public process::Observer {
 public:
  static constexpr std::size_t kSamples = 600;
  static constexpr canopen::Duration kPeriod = std::chrono::seconds(1);
  /// Of all drives together. Where they have more signals than that holds for ten minutes, the time is shorter.
  static constexpr std::size_t kMostBytes = 32UL * 1024 * 1024;
  /// Values that a piece of the JSON has at most, or else one sample: some half a millisecond's work.
  static constexpr std::size_t kValuesOfPiece = 2000;

  /// The plant outlives it.
  History(const boost::asio::any_io_executor& executor, const process::Plant& plant);

  void start();
  void stop();
  /// `{"drive":"pump1","period":1,"signals":["output_frequency"],"samples":[["…Z",49.97],["…Z",null]]}`, oldest first,
  /// engineering units, booleans as 0 and 1; null where the value was not fresh. The pieces end with the newest sample
  /// of now; one that was overwritten before its piece was worded is not in them, nor are those that were not worded
  /// when the configuration changed. The history outlives them.
  [[nodiscard]] Pieces json(std::size_t drive) const;

  void on_values(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) override {}
  void on_freshness(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) override {}
  void on_commanded(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) override {}
  void on_status(const process::Drive& /*drive*/) override {}
  void on_alarm(const process::Drive& /*drive*/, alarms::AlarmKind /*kind*/) override {}
  void on_bus(std::size_t /*bus*/) override {}
  /// Drives that stay keep their samples, unless there are so many signals now that fewer are kept of each.
  void on_plant_change(const process::PlantChange& change) override;

 private:
  /// One drive: its signals, and a ring of their values.
  struct Trend {
    std::vector<process::SignalId> signals;  ///< Readable, and a number.
    std::vector<float> values;               ///< Row by row.
  };

  [[nodiscard]] Trend make_trend(std::size_t drive) const;
  /// Samples that there is room for, of each drive.
  [[nodiscard]] std::size_t room() const;
  void begin();
  void sample();
  void arm();
  [[nodiscard]] std::string begin_json(std::size_t drive) const;
  void append_row(std::string& out, const Trend& trend, std::size_t row) const;

  const process::Plant& plant_;
  canopen::Timer timer_;
  bool runs_ = false;
  std::vector<Trend> trends_;
  std::size_t rows_ = kSamples;           ///< Kept of each drive.
  std::vector<canopen::WallTime> times_;  ///< By row.
  std::uint64_t taken_ = 0;               ///< Samples since the start.
};

}  // namespace gateway::http
