#pragma once

#include <array>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "bridges/modbus/addresses.h"
#include "bridges/modbus/exception.h"
#include "bridges/modbus/request.h"
#include "bridges/process/plant.h"
#include "canopen/clock.h"

namespace modbus {

/// The gateway itself, units 0 and 255: filled in when asked for, and read-only but for kStopRegister.
class GatewayUnit {
 public:
  /// `plant` outlives the unit.
  GatewayUnit(process::Plant& plant, config::WordOrder order);

  void set_mqtt_connected(bool connected) noexcept { mqtt_connected_ = connected; }
  void set_clients(std::size_t clients) noexcept { clients_ = clients; }
  void set_refused(std::uint64_t refused) noexcept { refused_ = refused; }
  /// Register 7: `count` is asked at every read.
  void count_lost_messages_by(std::function<std::uint64_t()> count) { lost_messages_ = std::move(count); }

  /// `out` holds range.quantity.
  [[nodiscard]] std::optional<Exception> read_registers(Range range, canopen::TimePoint now,
                                                        std::span<std::uint16_t> out) const;
  [[nodiscard]] std::optional<Exception> read_bits(Range range, std::span<std::uint8_t> out) const;

  /// It is a stop for all.
  [[nodiscard]] static bool is_stop(const Request& request);
  /// Nothing: every drive of this writer confirmed its stop. What request.values points to outlives the call.
  [[nodiscard]] boost::asio::awaitable<std::optional<Exception>> write(Request request, process::Origin origin);
  /// A write that is refused before it is looked at: of a stop for all each drive notes it.
  void note_refused(const Request& request, const process::Origin& origin, const canopen::Error& why);

 private:
  using BusBlock = std::array<std::uint16_t, kBusBlockSize>;

  [[nodiscard]] std::uint16_t general(std::uint16_t address, canopen::TimePoint now) const;
  [[nodiscard]] BusBlock bus_block(std::size_t bus) const;

  process::Plant& plant_;
  config::WordOrder order_;
  canopen::TimePoint started_;
  bool mqtt_connected_ = false;
  std::size_t clients_ = 0;
  std::uint64_t refused_ = 0;
  std::function<std::uint64_t()> lost_messages_;
};

}  // namespace modbus
