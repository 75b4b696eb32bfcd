#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "simulator/object_dictionary.h"
#include "simulator/pdo_rules.h"

namespace simulator {

/// The CANopen services of one kind of drive.
struct Traits {
  std::uint32_t device_type = 0;                         ///< 0x1000
  std::optional<std::array<std::uint32_t, 4>> identity;  ///< 0x1018; absent without a value
  std::string device_name;                               ///< 0x1008; absent when empty
  bool error_history = false;                            ///< 0x1003
  bool sync_objects = true;                              ///< 0x1005
  bool sync_counter = false;                             ///< 0x1019, SYNC with one byte
  bool emergency_objects = true;                         ///< 0x1014
  bool emergency_counts_sources = false;                 ///< "error reset" says how many errors are left
  bool node_guarding = false;                            ///< 0x100C, 0x100D, RTR
  std::uint8_t heartbeat_consumers = 0;                  ///< entries of 0x1016
  bool error_behaviour = false;                          ///< 0x1029
  bool keeps_settings_on_reset_communication = false;    ///< contrary to CiA 301
  bool short_sdo_requests = false;                       ///< accepts requests of fewer than 8 bytes
  bool segmented_sdo = true;
  std::vector<Abort> known_aborts;  ///< others become `general`; empty: knows all
  PdoRules pdo;
};

/// How a drive words a successful SDO answer.
struct AnswerStyle {
  bool trimmed = false;           ///< Only the bytes needed: 4 for a write, 4 + size for a read.
  bool upload_for_write = false;  ///< A write is answered in the form of a read.
  bool four_bytes = false;        ///< A 16-bit object is read as four bytes.
};

/// An EMCY before it becomes a frame.
struct EmergencyMessage {
  std::uint16_t code = 0;
  std::uint8_t error_register = 0;
  std::array<std::uint8_t, 5> vendor{};

  friend bool operator==(const EmergencyMessage&, const EmergencyMessage&) = default;
};

}  // namespace simulator
