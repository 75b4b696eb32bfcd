#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bridges/modbus/exception.h"
#include "bridges/modbus/process_table.h"
#include "bridges/modbus/request.h"
#include "bridges/process/drive.h"

namespace modbus {

/// What a write asks of a drive. Every address must be that of a writable signal, and a wide value must be written
/// whole. Limits, permission and the drive's state are the arbiter's business.
struct WritePlan {
  std::vector<process::FieldWrite> fields;
  /// Something beside them cannot be asked. Then nothing is sent, but for a stop.
  std::optional<Exception> mistake{};
};

/// `bytes`: two per register, high byte first. In a request that also writes 100, those of 101..103 that the drive
/// lacks take a 0, which is ignored; any other value of them is a mistake.
[[nodiscard]] WritePlan plan_registers(const ProcessTable& table, Range range, std::span<const std::uint8_t> bytes);
/// `bytes`: eight bits each, lowest first.
[[nodiscard]] WritePlan plan_bits(const ProcessTable& table, Range range, std::span<const std::uint8_t> bytes);

}  // namespace modbus
