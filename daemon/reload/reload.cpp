#include "daemon/reload/reload.h"

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

// For the drive's status.
std::string reason_of(const WaitingDrive& waiting) {
  return waiting.turns ? "waits for standstill" : "waits for the standstill of another drive";
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
  worker_.run([loaded, load = handlers_.load] { *loaded = load(); },
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
    co_await apply();
  }
  if (handlers_.ends) {
    handlers_.ends();
  }
}

boost::asio::awaitable<void> Reload::apply() {
  const config::Model& in_use = gateway_.plant().model();
  EffectiveModel effective = effective_model(in_use, *wanted_, turning());
  if (!is_none(config::difference(in_use, effective.model), in_use)) {
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
  }
  tell_waiting(std::move(effective.waiting));
  if (waiting_.empty()) {
    wanted_.reset();
    spdlog::info("reload: done, {}", config::summary(gateway_.plant().model()).substr(4));
  }
}

std::vector<bool> Reload::turning() const {
  const process::Plant& plant = gateway_.plant();
  std::vector<bool> turning;
  for (std::size_t i = 0; i < plant.size(); ++i) {
    const process::Turning told = plant.drive(i).turning();
    turning.push_back(told == process::Turning::yes || told == process::Turning::unknown);
  }
  return turning;
}

void Reload::tell_waiting(std::vector<WaitingDrive> waiting) {
  process::Plant& plant = gateway_.plant();
  for (const WaitingDrive& one : waiting) {
    if (std::ranges::find(waiting_, one) == waiting_.end()) {
      spdlog::warn("reload: drive {} {}{}", one.name, reason_of(one),
                   one.in_use ? ": until then it goes on as before" : "");
    }
  }
  waiting_ = std::move(waiting);
  for (std::size_t i = 0; i < plant.size(); ++i) {
    process::Drive& drive = plant.drive(i);
    const auto found = std::ranges::find(waiting_, drive.model().name, &WaitingDrive::name);
    drive.set_pending_change(found != waiting_.end() ? reason_of(*found) : std::string());
  }
}

}  // namespace gateway
