#include "bridges/modbus/write_plan.h"

#include <cstddef>

#include "bridges/modbus/addresses.h"
#include "bridges/modbus/words.h"

namespace modbus {
namespace {

const config::Signal* writable_signal(const ProcessTable& table, process::SignalId owner) {
  if (owner == kNoSignal) {
    return nullptr;
  }
  const config::Signal& signal = table.drive().signals[owner];
  return config::writable(signal.access) ? &signal : nullptr;
}

bool takes_ignored_zero(const ProcessTable& table, Range range, std::uint16_t address) {
  return address > kControlRegister && address <= kLastBesideIt && range.address <= kControlRegister &&
         table.register_owner(address) == kNoSignal;
}

}  // namespace

WritePlan plan_registers(const ProcessTable& table, Range range, std::span<const std::uint8_t> bytes) {
  WritePlan plan;
  for (std::size_t done = 0; done < range.quantity;) {
    const auto address = static_cast<std::uint16_t>(range.address + done);
    if (takes_ignored_zero(table, range, address) && bytes[2 * done] == 0 && bytes[2 * done + 1] == 0) {
      ++done;
      continue;
    }
    const process::SignalId owner = is_diagnostic(address) ? kNoSignal : table.register_owner(address);
    const config::Signal* const signal = writable_signal(table, owner);
    if (signal == nullptr || signal->modbus.address != address || done + signal->modbus.count > range.quantity) {
      plan.mistake = Exception::illegal_address;
      ++done;
      continue;
    }
    const auto words = bytes.subspan(2 * done, std::size_t{2} * signal->modbus.count);
    plan.fields.push_back({.signal = owner, .value = value_of(*signal, words, table.word_order())});
    done += signal->modbus.count;
  }
  return plan;
}

WritePlan plan_bits(const ProcessTable& table, Range range, std::span<const std::uint8_t> bytes) {
  WritePlan plan;
  for (std::size_t i = 0; i < range.quantity; ++i) {
    const process::SignalId owner = table.bit_owner(static_cast<std::uint16_t>(range.address + i));
    if (writable_signal(table, owner) == nullptr) {
      plan.mistake = Exception::illegal_address;
      continue;
    }
    const canopen::Raw bit = (canopen::Raw{bytes[i / 8]} >> (i % 8)) & 1U;
    plan.fields.push_back({.signal = owner, .value = bit});
  }
  return plan;
}

}  // namespace modbus
