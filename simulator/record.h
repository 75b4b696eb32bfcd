#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "canopen/clock.h"
#include "simulator/object_dictionary.h"

namespace simulator {

struct NmtCommand {
  std::uint8_t command = 0;
  std::uint8_t node = 0;  ///< 0: sent to all nodes
  canopen::TimePoint at;
};

/// What a drive has seen and done since it was made; power cycles do not clear it.
struct Record {
  static constexpr std::size_t kKept = 1000;  ///< NMT commands remembered, the latest.

  std::deque<NmtCommand> nmt_commands;  ///< Those meant for this drive or for all.
  std::uint64_t nmt_command_count = 0;
  std::map<Address, std::uint64_t> sdo_reads;     ///< Completed, per object.
  std::map<Address, std::uint64_t> sdo_writes;    ///< Completed, per object.
  std::map<Address, std::uint64_t> sdo_refusals;  ///< Per object, kKept of them; the rest counts as 0000:00.
  std::array<std::uint64_t, 8> rpdos{};           ///< Accepted, [0] is RPDO1.
  std::uint64_t rpdo_length_errors = 0;
  std::uint64_t tpdos = 0;
  std::uint64_t heartbeats = 0;  ///< Sent, boot-up frames not counted.
  std::uint64_t boot_ups = 0;
  std::uint64_t guarding_answers = 0;
  std::uint64_t emergencies = 0;
  std::uint64_t syncs = 0;
  std::uint64_t sync_length_errors = 0;
  std::uint64_t eeprom_writes = 0;  ///< Veichi: writes that wear the EEPROM.
  std::uint64_t run_commands = 0;   ///< Commands that set the motor going, obeyed or repeated.

  void note_nmt(const NmtCommand& command);
  void note_refusal(Address address);
  [[nodiscard]] static std::uint64_t total(const std::map<Address, std::uint64_t>& counts);
  [[nodiscard]] std::uint64_t rpdo_total() const;
};

}  // namespace simulator
