#pragma once

#include <cstdint>
#include <vector>

#include "bridges/modbus/addresses.h"
#include "bridges/process/image.h"
#include "config/model.h"

namespace modbus {

inline constexpr process::SignalId kNoSignal = 0xFFFF;

/// The registers and bits of one drive's signals, indexed by address from 0 on.
class ProcessTable {
 public:
  /// `drive` outlives the table.
  ProcessTable(const config::Drive& drive, config::WordOrder order);

  /// Rewrites all words of a signal. A signal without a place is left alone.
  void set(process::SignalId signal, canopen::Raw raw) noexcept;

  [[nodiscard]] bool has_register(std::uint16_t address) const noexcept;
  [[nodiscard]] bool has_bit(std::uint16_t address) const noexcept;
  /// kNoSignal where there is none.
  [[nodiscard]] process::SignalId register_owner(std::uint16_t address) const noexcept;
  [[nodiscard]] process::SignalId bit_owner(std::uint16_t address) const noexcept;
  /// 0 where there is no signal.
  [[nodiscard]] std::uint16_t register_value(std::uint16_t address) const noexcept;
  [[nodiscard]] bool bit_value(std::uint16_t address) const noexcept;

  [[nodiscard]] const config::Drive& drive() const noexcept { return drive_; }
  [[nodiscard]] config::WordOrder word_order() const noexcept { return order_; }

 private:
  struct Register {
    process::SignalId owner = kNoSignal;
    std::uint16_t value = 0;
  };
  struct Bit {
    process::SignalId owner = kNoSignal;
    bool value = false;
  };

  void place(process::SignalId signal);

  const config::Drive& drive_;
  config::WordOrder order_;
  std::vector<Register> registers_;  ///< As many as the highest address needs, at least kCommonAddresses.
  std::vector<Bit> bits_;            ///< Likewise.
};

}  // namespace modbus
