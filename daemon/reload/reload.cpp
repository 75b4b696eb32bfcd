#include "daemon/reload/reload.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <exception>
#include <utility>

#include "config/difference.h"
#include "daemon/gateway.h"

namespace gateway {
namespace {

void log_findings(const config::Findings& findings) {
  for (const config::Finding& finding : findings) {
    const bool is_error = finding.level == config::Finding::Level::error;
    spdlog::log(is_error ? spdlog::level::err : spdlog::level::warn, "{}", to_string(finding));
  }
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

// What would end a program that starts is not to end one that drives motors.
config::Loaded loaded_or_why(const std::function<config::Loaded()>& load) {
  try {
    return load();
  } catch (const std::exception& failure) {
    return {.model = std::nullopt,
            .findings = {{.file = "the configuration", .text = std::string("it cannot be read: ") + failure.what()}}};
  }
}

}  // namespace

Reload::Reload(const boost::asio::any_io_executor& executor, Gateway& gateway, Handlers handlers)
    : executor_(executor), gateway_(gateway), handlers_(std::move(handlers)), worker_(executor), changed_(executor) {}

void Reload::start() {
  running_ = true;
  boost::asio::co_spawn(executor_, run(), [this](const std::exception_ptr& error) {
    running_ = false;
    changed_.notify();
    if (error) {
      std::rethrow_exception(error);
    }
  });
}

void Reload::request() {
  requested_ = true;
  changed_.notify();
}

boost::asio::awaitable<void> Reload::stop() {
  stopping_ = true;
  gateway_.end_is_near();
  changed_.notify();
  while (running_) {
    co_await changed_.wait_until(canopen::kNever);
  }
}

boost::asio::awaitable<void> Reload::run() {
  while (!stopping_) {
    if (std::exchange(requested_, false)) {
      co_await take();
      continue;
    }
    if (wanted_) {
      co_await apply();
    }
    if (!stopping_ && !requested_) {
      const canopen::TimePoint next = wanted_ ? canopen::Clock::now() + kLook : canopen::kNever;
      co_await changed_.wait_until(next);
    }
  }
}

boost::asio::awaitable<std::shared_ptr<config::Loaded>> Reload::load() {
  // The thread may outlive us where a file system hangs.
  auto loaded = std::make_shared<config::Loaded>();
  auto done = std::make_shared<bool>(false);
  worker_.run([loaded, load = handlers_.load] { *loaded = loaded_or_why(load); },
              [this, done] {
                *done = true;
                changed_.notify();
              });
  while (!*done && !stopping_) {
    co_await changed_.wait_until(canopen::kNever);
  }
  co_return *done ? std::move(loaded) : nullptr;
}

boost::asio::awaitable<void> Reload::take() {
  spdlog::info("reload: the configuration is read");
  if (handlers_.begins) {
    handlers_.begins();
  }
  const std::shared_ptr<config::Loaded> loaded = co_await load();
  if (!loaded) {
    co_return;  // The gateway ends.
  }
  log_findings(loaded->findings);
  if (!loaded->model) {
    spdlog::error("reload: the configuration has errors: nothing was changed");
  } else if (const std::vector<std::string> keys = config::difference(gateway_.plant().model(), *loaded->model).gateway;
             !keys.empty()) {
    spdlog::error("reload: nothing was changed: another value of {} in [gateway] needs a restart", listed(keys));
  } else {
    wanted_ = std::move(*loaded->model);
    seen_.clear();
    told_.clear();
    co_await gateway_.change_sections(*wanted_);
    if (!stopping_) {
      co_await apply();
    }
  }
  if (handlers_.ends) {
    handlers_.ends();
  }
}

boost::asio::awaitable<void> Reload::apply() {
  const process::Plant& plant = gateway_.plant();
  std::vector<Hold> seen;
  std::vector<bool> stays;
  for (std::size_t i = 0; i < plant.size(); ++i) {
    seen.push_back(hold_of(plant.drive(i)));
    stays.push_back(seen.back() != Hold::none);
  }
  if (!seen_.empty() && seen == seen_) {
    co_return;
  }
  EffectiveModel effective = effective_model(plant.model(), *wanted_, stays);
  if (is_none(config::difference(plant.model(), effective.model), plant.model())) {
    seen_ = std::move(seen);
  } else {
    seen_.clear();
    // Nothing may wait between the look above and the moment when those that leave take no command any more.
    auto model = std::make_shared<const config::Model>(std::move(effective.model));
    std::string failure;
    try {
      co_await gateway_.change(std::move(model));
    } catch (const std::exception& error) {
      failure = error.what();
    }
    if (!failure.empty()) {
      spdlog::error("reload: the configuration cannot be taken: {}", failure);
      wanted_.reset();
      tell_waiting({});
      co_return;
    }
    if (stopping_) {
      co_return;
    }
  }
  tell_waiting(std::move(effective.waiting));
  if (waiting_.empty()) {
    wanted_.reset();
    spdlog::info("reload: done, {}", config::summary(plant.model()).substr(4));
  }
}

// What two drives say under one node id tells nothing of either, and the proof of it would be lost with its node. That
// which mends it is not to wait for it.
Reload::Hold Reload::hold_of(const process::Drive& drive) const {
  if (drive.status().doubled != canopen::Doubled::no && keeps_its_place(drive)) {
    return Hold::doubled;
  }
  switch (drive.turning()) {
    case process::Turning::yes:
      return Hold::turns;
    case process::Turning::unknown:
      return Hold::unknown;
    case process::Turning::no:
    case process::Turning::untold:
      break;
  }
  return Hold::none;
}

// As it is wanted it has the node id, on the bus, where it is now.
bool Reload::keeps_its_place(const process::Drive& drive) const {
  const auto at = config::find_named(wanted_->drives, drive.model().name);
  if (!at) {
    return false;
  }
  const config::Drive& then = wanted_->drives[*at];
  const config::Bus& bus_then = wanted_->buses[then.bus];
  const config::Bus& bus = gateway_.plant().model().buses[drive.bus()];
  return then.enabled && then.node.node == drive.model().node.node && bus_then.name == bus.name &&
         bus_then.interface == bus.interface;
}

// For the drive's status.
std::string Reload::reason_of(const WaitingDrive& waiting) const {
  if (!waiting.turns) {
    return "waits for the standstill of another drive";
  }
  const process::Drive* const drive = gateway_.plant().find(waiting.name);
  switch (drive != nullptr ? hold_of(*drive) : Hold::none) {
    case Hold::unknown:
      return "waits, as nobody can tell whether its motor turns (`running` is not fresh): let it stand still, then "
             "disconnect or switch it off, or restart the gateway";
    case Hold::doubled:
      return "waits, as two drives have its node id";
    case Hold::none:
    case Hold::turns:
      break;
  }
  return "waits for standstill";
}

void Reload::tell_waiting(std::vector<WaitingDrive> waiting) {
  waiting_ = std::move(waiting);
  for (const WaitingDrive& one : waiting_) {
    std::string line =
        fmt::format("drive {} {}{}", one.name, reason_of(one), one.in_use ? ": until then it goes on as before" : "");
    if (!told_.contains(line)) {
      spdlog::warn("reload: {}", line);
      told_.insert(std::move(line));
    }
  }
  process::Plant& plant = gateway_.plant();
  for (std::size_t i = 0; i < plant.size(); ++i) {
    process::Drive& drive = plant.drive(i);
    const auto found = std::ranges::find(waiting_, drive.model().name, &WaitingDrive::name);
    drive.set_pending_change(found != waiting_.end() ? reason_of(*found) : std::string());
  }
}

}  // namespace gateway
