#include "bridges/modbus/process_table.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "bridges/modbus/words.h"

namespace modbus {
namespace {

constexpr std::size_t kMaxWords = 4;

template <class Cell>
void claim(std::vector<Cell>& cells, std::size_t address, std::size_t count, process::SignalId owner) {
  cells.resize(std::max(cells.size(), address + count));
  for (std::size_t i = 0; i < count; ++i) {
    cells[address + i].owner = owner;
  }
}

}  // namespace

ProcessTable::ProcessTable(const config::Drive& drive, config::WordOrder order)
    : drive_(drive), order_(order), registers_(kCommonAddresses), bits_(kCommonAddresses) {
  for (std::size_t i = 0; i < drive.signals.size(); ++i) {
    place(static_cast<process::SignalId>(i));
  }
}

void ProcessTable::place(process::SignalId signal) {
  const config::ModbusPlace& where = drive_.signals[signal].modbus;
  if (where.kind == config::ModbusKind::holding) {
    claim(registers_, where.address, std::min<std::size_t>(where.count, kMaxWords), signal);
  } else if (where.kind == config::ModbusKind::bit) {
    claim(bits_, where.address, 1, signal);
  }
}

void ProcessTable::set(process::SignalId signal, canopen::Raw raw) noexcept {
  const config::Signal& what = drive_.signals[signal];
  const config::ModbusPlace& where = what.modbus;
  if (where.kind == config::ModbusKind::bit) {
    bits_[where.address].value = raw != 0;
    return;
  }
  if (where.kind != config::ModbusKind::holding) {
    return;
  }
  std::array<std::uint16_t, kMaxWords> words{};
  const std::size_t count = std::min<std::size_t>(where.count, kMaxWords);
  put_value(what, raw, order_, std::span(words).first(count));
  for (std::size_t i = 0; i < count; ++i) {
    registers_[where.address + i].value = words[i];
  }
}

bool ProcessTable::has_register(std::uint16_t address) const noexcept {
  return address < kCommonAddresses || register_owner(address) != kNoSignal;
}

bool ProcessTable::has_bit(std::uint16_t address) const noexcept {
  return address < kCommonAddresses || bit_owner(address) != kNoSignal;
}

process::SignalId ProcessTable::register_owner(std::uint16_t address) const noexcept {
  return address < registers_.size() ? registers_[address].owner : kNoSignal;
}

process::SignalId ProcessTable::bit_owner(std::uint16_t address) const noexcept {
  return address < bits_.size() ? bits_[address].owner : kNoSignal;
}

std::uint16_t ProcessTable::register_value(std::uint16_t address) const noexcept {
  return address < registers_.size() ? registers_[address].value : std::uint16_t{0};
}

bool ProcessTable::bit_value(std::uint16_t address) const noexcept {
  return address < bits_.size() && bits_[address].value;
}

}  // namespace modbus
