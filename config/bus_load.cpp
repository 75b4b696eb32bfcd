#include "config/bus_load.h"

#include <algorithm>
#include <chrono>
#include <map>

#include "canopen/bus/wire_bits.h"

namespace config {
namespace {

// CiA 301 §7.2.8.3.2.2, §7.2.5 (without a counter), §7.2.4.3.
constexpr std::uint32_t kHeartbeatBytes = 1;
constexpr std::uint32_t kSyncBytes = 0;
constexpr std::uint32_t kSdoBytes = 8;

/// Bits per second.
struct Traffic {
  double usual = 0;
  double worst = 0;
};

Traffic operator+(const Traffic& a, const Traffic& b) {
  return {a.usual + b.usual, a.worst + b.worst};
}

double per_second(Duration period) {
  return period > Duration::zero() ? 1.0 / std::chrono::duration<double>(period).count() : 0.0;
}

/// Frames of one length; zero as a period: none come.
Traffic frames(std::uint32_t bytes, Duration usual_period, Duration worst_period) {
  return {per_second(usual_period) * canopen::wire_bits(bytes, canopen::Stuffing::usual),
          per_second(worst_period) * canopen::wire_bits(bytes, canopen::Stuffing::worst)};
}

Traffic frames(std::uint32_t bytes, Duration period) {
  return frames(bytes, period, period);
}

std::uint32_t byte_count(const canopen::PdoSettings& pdo) {
  std::uint32_t bits = 0;
  for (const canopen::MappedObject& mapped : pdo.mapping) {
    bits += mapped.bits;
  }
  return (bits + 7) / 8;
}

/// CiA 301 table 72: 254 and 255. A type that is left as the drive has it may be one of them.
bool is_event_driven(const canopen::PdoSettings& tpdo) {
  constexpr unsigned kFirstEventDriven = 254;
  return tpdo.transmission_type.value_or(kFirstEventDriven) >= kFirstEventDriven;
}

bool is_unlimited(const canopen::PdoSettings& tpdo) {
  return is_event_driven(tpdo) && tpdo.shortest_period == Duration::zero();
}

Traffic tpdo_traffic(const canopen::PdoSettings& tpdo, Duration sync) {
  const std::uint32_t bytes = byte_count(tpdo);
  if (tpdo.transmission_type == 0) {
    return frames(bytes, Duration::zero(), sync);
  }
  if (!is_event_driven(tpdo) || is_unlimited(tpdo)) {
    return frames(bytes, tpdo.period);
  }
  // At rest nothing changes, so the event timer alone sends it.
  const bool timed = tpdo.period > Duration::zero();
  return frames(bytes, timed ? std::max(tpdo.period, tpdo.shortest_period) : Duration::zero(), tpdo.shortest_period);
}

/// One with a field that nothing says the meaning of is never sent.
Traffic rpdo_traffic(const canopen::PdoSettings& rpdo) {
  const bool sent = std::none_of(rpdo.mapping.begin(), rpdo.mapping.end(),
                                 [](const auto& field) { return field.use == canopen::FieldUse::unnamed; });
  return sent ? frames(byte_count(rpdo), Duration::zero(), canopen::repeat_time(rpdo)) : Traffic{};
}

/// Request and answer. What does not fit into the four bytes of the first answer comes in segments of seven.
Traffic poll_traffic(canopen::DataType type, Duration poll) {
  constexpr unsigned kExpeditedBytes = 4;
  constexpr unsigned kSegmentBytes = 7;
  const unsigned bytes = canopen::byte_length(type);
  const unsigned segments = bytes <= kExpeditedBytes ? 0 : (bytes + kSegmentBytes - 1) / kSegmentBytes;
  const Traffic frame = frames(kSdoBytes, poll);
  const double count = 2.0 * (1 + segments);
  return {count * frame.usual, count * frame.worst};
}

/// Everything readable that no TPDO brings, each object once, as often as the most impatient of its signals asks.
Traffic polls_of(const Drive& drive) {
  struct Poll {
    canopen::DataType type;
    Duration period;
  };
  std::map<canopen::ObjectAddress, Poll> polls;
  for (const Signal& signal : drive.signals) {
    if (readable(signal.access) && !signal.derived && signal.source.kind != SourceKind::tpdo) {
      Poll& poll = polls.try_emplace(signal.object, Poll{signal.type, signal.poll}).first->second;
      poll.period = std::min(poll.period, signal.poll);
    }
  }
  Traffic sum;
  for (const auto& [object, poll] : polls) {
    sum = sum + poll_traffic(poll.type, poll.period);
  }
  return sum;
}

/// All that a drive causes but its polls.
Traffic process_data_of(const Drive& drive, Duration sync) {
  const canopen::ErrorControlSettings& control = drive.node.error_control;
  Traffic sum = frames(kHeartbeatBytes, control.heartbeat);
  sum = sum + frames(0, control.guarding) + frames(kHeartbeatBytes, control.guarding);  // Request and answer.
  for (const canopen::PdoSettings& tpdo : drive.node.tpdos) {
    sum = sum + tpdo_traffic(tpdo, sync);
  }
  if (drive.commands.writers.any()) {
    for (const canopen::PdoSettings& rpdo : drive.node.rpdos) {
      sum = sum + rpdo_traffic(rpdo);
    }
  }
  return sum;
}

}  // namespace

std::optional<BusLoad> forecast_load(const Model& model, std::size_t bus) {
  const Bus& line = model.buses[bus];
  const double bitrate = line.bitrate.value_or(0);
  if (bitrate <= 0) {
    return std::nullopt;
  }
  Traffic all = frames(kSyncBytes, line.sync);
  if (line.node_id != 0) {
    all = all + frames(kHeartbeatBytes, line.heartbeat);
  }
  Traffic polls;
  bool at_least = false;
  for (const Drive& drive : model.drives) {
    if (drive.bus == bus && drive.enabled) {
      all = all + process_data_of(drive, line.sync);
      polls = polls + polls_of(drive);
      const auto& tpdos = drive.node.tpdos;
      at_least = at_least || std::any_of(tpdos.begin(), tpdos.end(), is_unlimited);
    }
  }
  all = all + polls;
  return BusLoad{all.usual / bitrate, all.worst / bitrate, polls.worst / bitrate, at_least};
}

}  // namespace config
