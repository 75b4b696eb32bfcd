#include "bridges/modbus/diagnostics.h"

#include <algorithm>
#include <chrono>
#include <optional>

#include "bridges/modbus/words.h"

namespace modbus {
namespace {

constexpr std::uint16_t kNoAge = 65535;

std::uint16_t age_ms(std::optional<canopen::TimePoint> since, canopen::TimePoint now) {
  if (!since) {
    return kNoAge;
  }
  const auto age = std::chrono::duration_cast<std::chrono::milliseconds>(now - *since).count();
  return static_cast<std::uint16_t>(std::clamp<std::int64_t>(age, 0, kNoAge));
}

// Of all sources that the drive has; one that never came has no age, so that nobody takes the block for complete.
std::optional<canopen::TimePoint> oldest_value(const process::Image& image) {
  std::optional<canopen::TimePoint> oldest;
  for (const process::SourceState& source : image.sources()) {
    if (source.absent) {
      continue;
    }
    if (!source.received) {
      return std::nullopt;
    }
    oldest = oldest ? std::min(*oldest, source.at) : source.at;
  }
  return oldest;
}

std::uint16_t state_bits(const process::Drive& drive, canopen::TimePoint now) {
  const canopen::NodeStatus& status = drive.status();
  const process::ControlState control = drive.control();
  const std::array bits{status.online,
                        status.nmt_now() == canopen::NmtState::operational,
                        drive.has_fault_alarm(),
                        drive.has_warning_alarm(),
                        drive.image().all_fresh(now),
                        status.configured,
                        control.timeout,
                        control.holder.has_value()};
  std::uint16_t word = 0;
  for (std::size_t i = 0; i < bits.size(); ++i) {
    word = static_cast<std::uint16_t>(word | (bits[i] ? 1U << i : 0U));
  }
  return word;
}

}  // namespace

Diagnostics diagnostics_of(const process::Drive& drive, config::WordOrder order, canopen::TimePoint now) {
  const canopen::NodeStatus& status = drive.status();
  const alarms::Alarm& emergency = drive.alarm(alarms::AlarmKind::emcy);
  Diagnostics block{};
  block[0] = state_bits(drive, now);
  block[1] = static_cast<std::uint16_t>(status.nmt_now());
  block[2] = static_cast<std::uint16_t>(status.boot_result);
  block[4] = emergency.error_register;
  if (emergency.active) {
    block[3] = emergency.code;
    block[5] = static_cast<std::uint16_t>(emergency.vendor[0] << 8 | emergency.vendor[1]);
    block[6] = static_cast<std::uint16_t>(emergency.vendor[2] << 8 | emergency.vendor[3]);
    block[7] = static_cast<std::uint16_t>(emergency.vendor[4] << 8);
    block[15] = static_cast<std::uint16_t>(emergency.errors.size());
  }
  block[8] = age_ms(status.last_heartbeat, now);
  block[9] = age_ms(oldest_value(drive.image()), now);
  block[10] = static_cast<std::uint16_t>(status.boot_ups);
  block[11] = static_cast<std::uint16_t>(status.emergencies);
  put_words(drive.last_refused_abort(), order, std::span(block).subspan<12, 2>());
  block[14] = static_cast<std::uint16_t>(status.heartbeat_losses);
  block[17] = static_cast<std::uint16_t>(std::min<std::size_t>(drive.last_written(), 0xFFFF));
  return block;
}

}  // namespace modbus
