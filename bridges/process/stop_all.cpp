#include "bridges/process/stop_all.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/this_coro.hpp>
#include <exception>
#include <utility>

#include "bridges/process/command_checks.h"
#include "canopen/event.h"

namespace process {
namespace {

bool takes_commands(const config::Drive& model, const Writer& writer) {
  return model.enabled && !refuse_writer(model, writer);
}

struct Round {
  explicit Round(boost::asio::any_io_executor executor) : ended(std::move(executor)) {}

  std::size_t waiting = 0;
  std::vector<NotStopped> not_stopped;
  canopen::Event ended;
};

boost::asio::awaitable<void> stop_one(Drive& drive, Origin origin, Round& round) {
  const Outcome outcome = co_await drive.stop_motor(std::move(origin));
  if (outcome.has_error()) {
    round.not_stopped.push_back({.drive = drive.index(), .name = drive.model().name, .error = outcome.error()});
  }
  --round.waiting;
  round.ended.notify();
}

}  // namespace

std::size_t commanded_by(const Plant& plant, const Writer& writer) {
  return static_cast<std::size_t>(std::ranges::count_if(
      plant.model().drives, [&](const config::Drive& model) { return takes_commands(model, writer); }));
}

boost::asio::awaitable<std::vector<NotStopped>> stop_all(Plant& plant, Origin origin) {
  if (commanded_by(plant, origin.writer) == 0) {
    refuse_stop_all(plant, origin,
                    {.kind = canopen::ErrorKind::forbidden, .detail = "a stop for all, and no drive takes commands"});
  }
  const boost::asio::any_io_executor executor = co_await boost::asio::this_coro::executor;
  Round round(executor);
  for (std::size_t i = 0; i < plant.size(); ++i) {
    Drive& drive = plant.drive(i);
    if (!takes_commands(drive.model(), origin.writer)) {
      continue;
    }
    ++round.waiting;
    boost::asio::co_spawn(executor, stop_one(drive, origin, round), [](const std::exception_ptr& failure) {
      if (failure) {
        std::rethrow_exception(failure);
      }
    });
  }
  while (round.waiting > 0) {
    co_await round.ended.wait_until(canopen::kNever);
  }
  std::ranges::sort(round.not_stopped, {}, &NotStopped::drive);
  co_return std::move(round.not_stopped);
}

void refuse_stop_all(Plant& plant, const Origin& origin, const canopen::Error& why) {
  for (std::size_t i = 0; i < plant.size(); ++i) {
    (void)plant.drive(i).refuse(origin, CommandRecord::Kind::write, why);
  }
}

}  // namespace process
