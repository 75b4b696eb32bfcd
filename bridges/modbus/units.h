#pragma once

#include <array>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "bridges/modbus/drive_unit.h"
#include "bridges/modbus/encapsulated.h"
#include "bridges/modbus/exception.h"
#include "bridges/modbus/flat_unit.h"
#include "bridges/modbus/gateway_unit.h"
#include "bridges/modbus/request.h"
#include "bridges/modbus/snapshot.h"
#include "bridges/process/plant.h"
#include "bridges/process/plant_change.h"

namespace modbus {

/// Who answers under which unit id: the drives, the flat unit, and the gateway under 0 and 255.
class Units {
 public:
  /// `plant` and `settings` outlive the units.
  Units(process::Plant& plant, const config::Modbus& settings);

  /// The plant changed. A drive that stays has its unit object as it was; what is under way there goes on.
  void change(const process::PlantChange& change);

  [[nodiscard]] bool has(std::uint8_t unit) const noexcept;
  /// Reads request.read. The unit exists.
  [[nodiscard]] std::optional<Exception> read(std::uint8_t unit, const Request& request, canopen::TimePoint now,
                                              Snapshot& into) const;
  /// A client of `write_from` asked this unit for `request`, whatever that is. The unit exists.
  void sign_of_life(std::uint8_t unit, const Request& request, const process::Writer& writer);
  /// The request stops a drive, or all.
  [[nodiscard]] bool is_stop(std::uint8_t unit, const Request& request) const;
  /// Since when the drive is there that a request of function 43, or what it writes, is for: one that came before was
  /// meant for another drive, which the plant had there until it changed. min(): from the start, or it is for none.
  [[nodiscard]] canopen::TimePoint there_since(std::uint8_t unit, const Request& request) noexcept;
  /// A write that is refused before its unit sees it: the drive notes it, of a stop for all each.
  void note_refused(std::uint8_t unit, const Request& request, process::Origin origin, canopen::Error why);
  /// Of function 23: it was written, and what it was to read failed after that with `answered`. For the log.
  void note_unread(std::uint8_t unit, const Request& request, const process::Writer& writer, Exception answered);
  /// Writes request.write, which must stay valid. The unit exists.
  [[nodiscard]] boost::asio::awaitable<std::optional<Exception>> write(std::uint8_t unit, Request request,
                                                                       process::Origin origin);

  /// Answers function 43; what request.encapsulated points to outlives the call. The unit exists. `may_write`: the
  /// client is of `write_from`.
  [[nodiscard]] boost::asio::awaitable<EncapsulatedAnswer> encapsulated(std::uint8_t unit, Request request,
                                                                        process::Origin origin, bool may_write);

  [[nodiscard]] GatewayUnit& gateway() noexcept { return gateway_; }
  /// Null where the drive is not on Modbus.
  [[nodiscard]] DriveUnit* of_drive(std::size_t index) const noexcept { return of_drive_[index].get(); }

 private:
  static constexpr std::size_t kUnitIds = 256;
  [[nodiscard]] static bool is_gateway(std::uint8_t unit) noexcept { return unit == 0 || unit == kUnitIds - 1; }
  [[nodiscard]] bool is_flat(std::uint8_t unit) const noexcept { return unit == flat_unit_; }
  /// Whom function 43/13 means: of a drive's unit only that drive, of others the first bus that has the node. Null:
  /// nobody.
  [[nodiscard]] process::Drive* drive_of(std::uint8_t unit, std::uint8_t node) noexcept;
  [[nodiscard]] std::unique_ptr<DriveUnit> make_unit(std::size_t drive) const;
  boost::asio::awaitable<EncapsulatedAnswer> identify_unit(std::uint8_t unit, std::span<const std::uint8_t> pdu);

  process::Plant& plant_;
  config::WordOrder order_;
  std::optional<std::uint8_t> flat_unit_;
  GatewayUnit gateway_;
  std::vector<std::unique_ptr<DriveUnit>> of_drive_;  ///< By position in the plant.
  std::vector<canopen::TimePoint> since_;             ///< Likewise; see there_since().
  FlatUnit flat_;
  std::array<DriveUnit*, kUnitIds> by_id_{};
};

}  // namespace modbus
