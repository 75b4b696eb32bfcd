#include "daemon/supervision.h"

#include <fmt/format.h>
#include <systemd/sd-daemon.h>

#include <cstdint>
#include <utility>

namespace gateway {

Supervision::Supervision(const boost::asio::any_io_executor& executor, const process::Plant& plant,
                         std::function<bool()> alive)
    : plant_(plant), timer_(executor), period_(std::chrono::seconds(1)), alive_(std::move(alive)) {
  std::uint64_t watchdog_us = 0;
  watched_ = sd_watchdog_enabled(0, &watchdog_us) > 0;
  if (watched_) {
    // Three signs of life per watchdog time: one may be late without a restart of the whole gateway.
    period_ = std::min<canopen::Duration>(period_, std::chrono::microseconds(watchdog_us) / 3);
  }
}

void Supervision::ready() {
  if (stopping_) {
    return;
  }
  sd_notify(0, "READY=1");
  tick();
}

void Supervision::reloading() {
  const auto now = std::chrono::duration_cast<std::chrono::microseconds>(canopen::Clock::now().time_since_epoch());
  sd_notify(0, fmt::format("RELOADING=1\nMONOTONIC_USEC={}", now.count()).c_str());
}

void Supervision::stopping() {
  stopping_ = true;
  timer_.cancel();
  sd_notify(0, "STOPPING=1");
}

void Supervision::tick() {
  if (watched_ && alive_()) {
    sd_notify(0, "WATCHDOG=1");
  }
  if (std::string line = status_line(plant_); line != told_) {
    sd_notify(0, ("STATUS=" + line).c_str());
    told_ = std::move(line);
  }
  timer_.expires_after(period_);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      tick();
    }
  });
}

std::string status_line(const process::Plant& plant) {
  std::string line = fmt::format("{} of {} drives online", plant.online(), plant.size());
  if (const std::size_t alarms = plant.with_alarm(); alarms > 0) {
    line += fmt::format(", {} with an alarm", alarms);
  }
  std::size_t waiting = 0;
  for (std::size_t i = 0; i < plant.size(); ++i) {
    waiting += plant.drive(i).pending_change().empty() ? 0U : 1U;
  }
  if (waiting > 0) {
    line += fmt::format(", {} to be changed at standstill", waiting);
  }
  return line;
}

}  // namespace gateway
