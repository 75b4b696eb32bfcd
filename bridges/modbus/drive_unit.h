#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bridges/modbus/diagnostics.h"
#include "bridges/modbus/exception.h"
#include "bridges/modbus/process_table.h"
#include "bridges/modbus/request.h"
#include "bridges/modbus/write_plan.h"
#include "bridges/process/plant.h"

namespace modbus {

/// One drive as a Modbus unit. Its table follows the image in the very call that changes it; nothing here waits but
/// write(), so that no request sees half an update.
class DriveUnit {
 public:
  /// Both outlive the unit.
  DriveUnit(const process::Plant& plant, process::Drive& drive, config::WordOrder order);

  [[nodiscard]] process::Drive& drive() const noexcept { return drive_; }

  void on_values(std::span<const process::SignalId> signals);
  void sign_of_life(const process::Writer& writer);

  /// `out` holds range.quantity.
  [[nodiscard]] std::optional<Exception> read_registers(Range range, canopen::TimePoint now,
                                                        std::span<std::uint16_t> out) const;
  [[nodiscard]] std::optional<Exception> read_bits(Range range, canopen::TimePoint now,
                                                   std::span<std::uint8_t> out) const;
  [[nodiscard]] bool is_stop(const Request& request) const;
  /// A write that is refused before it is looked at: the drive notes it. Returns what is to be told: who may not
  /// command it at all hears that.
  Exception note_refused(const Request& request, process::Origin origin, canopen::Error why);
  /// Nothing: confirmed. What request.values points to outlives the call.
  [[nodiscard]] boost::asio::awaitable<std::optional<Exception>> write(Request request, process::Origin origin);

 private:
  void show(process::SignalId signal);
  enum class Quality : std::uint8_t {
    good,
    stale,  ///< Only measured values can be out of date; a command register never makes a read fail.
    absent  ///< The drive lacks it: as an unused address.
  };
  [[nodiscard]] Quality quality(process::SignalId signal, canopen::TimePoint now) const;
  [[nodiscard]] static bool shows_zero(Quality found, config::OnStale on_stale) noexcept;
  [[nodiscard]] Diagnostics diagnostics(Range range, canopen::TimePoint now) const;
  [[nodiscard]] WritePlan plan_mask(const Request& request) const;
  [[nodiscard]] WritePlan plan(const Request& request, std::span<const std::uint8_t> bytes) const;
  /// `number`: nothing where bits alone were asked for.
  boost::asio::awaitable<std::optional<Exception>> write_nmt(std::optional<std::uint16_t> number,
                                                             process::Origin origin);

  const process::Plant& plant_;
  process::Drive& drive_;
  ProcessTable table_;
  std::vector<bool> measured_;  ///< Per signal: its value comes from the drive, not from a command.
  std::uint16_t last_nmt_command_ = 0;
};

}  // namespace modbus
