#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/bus/bus_state.h"
#include "canopen/clock.h"

namespace process {

class Plant;

struct BusHealth {
  std::string name{};
  canopen::BusCondition condition = canopen::BusCondition::down;
  std::optional<double> load{};  ///< Of the last second, 0..1; nothing where no bit rate is known.
  bool in_service = true;        ///< A drive in service is on it; not shown.
  friend bool operator==(const BusHealth&, const BusHealth&) = default;
};

/// The connection to an MQTT broker.
struct BrokerHealth {
  std::optional<std::string> broker{};    ///< `HOST:PORT`; nothing while there is no connection.
  std::optional<std::string> protocol{};  ///< `5` or `3.1.1`; likewise.
  std::vector<std::string> refused{};     ///< Topic filters whose subscription does not stand.
  std::string last_break{};               ///< Why the last connection ended; empty: none did.
  std::optional<std::string> other{};     ///< Instance of another gateway of this name; nothing: there is none.
  std::uint64_t put_right = 0;            ///< Topics that others had overwritten.
  std::uint64_t messages_dropped = 0;
  std::uint64_t answers_dropped = 0;
  friend bool operator==(const BrokerHealth&, const BrokerHealth&) = default;
};

/// What only the program itself knows.
struct ProgramHealth {
  canopen::Duration uptime{};
  std::uint64_t memory = 0;    ///< Resident, in bytes.
  std::uint64_t log_lost = 0;  ///< Messages that the log dropped.
  std::string journal{};       ///< Newest hash of the journal; empty: no journal.
  bool clock_set = true;       ///< The time of day was set since the machine started.
  friend bool operator==(const ProgramHealth&, const ProgramHealth&) = default;
};

/// How the gateway is, for people and for what supervises it.
struct Health {
  canopen::WallTime ts{};
  std::string instance{};  ///< Of this life of the program.
  ProgramHealth program{};
  std::vector<BusHealth> buses{};
  std::size_t drives = 0;
  std::size_t in_service = 0;            ///< Drives; not shown.
  std::size_t online = 0;                ///< Drives.
  std::optional<BrokerHealth> broker{};  ///< Nothing: MQTT is off.
  friend bool operator==(const Health&, const Health&) = default;
};

/// The part that the plant knows; `ts` is now.
[[nodiscard]] Health health_of(const Plant& plant);

/// Something other than the time, the uptime, loads and the memory is different.
[[nodiscard]] bool differs(const Health& one, const Health& other);

/// The gateway does its work: every bus with a drive in service can carry frames, and of these drives one at least is
/// online. A broker that is away takes nothing from Modbus, so it does not count.
[[nodiscard]] bool is_well(const Health& health);

/// `{"ts":"…Z","uptime":12,"buses":[{"name":"can0","state":"active","load":0.123}],…}`; see docs/MQTT.md.
[[nodiscard]] std::string health_json(const Health& health);

}  // namespace process
