#include "bridges/process/stop_all.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/this_coro.hpp>
#include <exception>
#include <utility>

#include "bridges/process/command_checks.h"
#include "bridges/process/drive.h"
#include "canopen/event.h"

namespace process {
namespace {

// The node, the object and the abort are not what whoever stops a plant looks for first.
std::string short_text(const canopen::Error& error) {
  std::string text = error.detail.empty() ? canopen::to_string(error) : error.detail;
  if (error.outcome_unknown && !error.detail.empty()) {
    text += ", outcome unknown";
  }
  return text;
}

boost::asio::awaitable<void> stop_one(Drive& drive, Origin origin, std::optional<canopen::Error>& failure) {
  Outcome outcome = co_await drive.stop_motor(std::move(origin));
  failure = std::move(outcome.failure);
}

}  // namespace

Outcome StoppedAll::outcome() const {
  if (asked == 0) {
    return canopen::Error{.kind = canopen::ErrorKind::forbidden, .detail = "no drive takes commands of this writer"};
  }
  if (missed.empty()) {
    return {};
  }
  canopen::Error error{.kind = missed.front().error.kind, .detail = "not confirmed: "};
  for (const Missed& one : missed) {
    error.detail += (&one == &missed.front() ? "" : "; ") + one.drive + " (" + short_text(one.error) + ")";
  }
  return error;
}

boost::asio::awaitable<StoppedAll> stop_all(Plant& plant, Origin origin) {
  const auto executor = co_await boost::asio::this_coro::executor;
  canopen::Event answered(executor);
  std::size_t under_way = 0;
  std::vector<std::optional<canopen::Error>> failures(plant.size());
  StoppedAll result;
  for (std::size_t i = 0; i < plant.size(); ++i) {
    Drive& drive = plant.drive(i);
    if (!drive.model().enabled || refuse_writer(drive.model(), origin.writer)) {
      continue;
    }
    ++result.asked;
    ++under_way;
    boost::asio::co_spawn(executor, stop_one(drive, origin, failures[i]),
                          [&under_way, &answered](const std::exception_ptr& failure) {
                            --under_way;
                            answered.notify();
                            if (failure) {
                              std::rethrow_exception(failure);
                            }
                          });
  }
  while (under_way != 0) {
    co_await answered.wait_until(canopen::kNever);
  }
  for (std::size_t i = 0; i < failures.size(); ++i) {
    if (failures[i]) {
      result.missed.push_back({plant.drive(i).model().name, *std::move(failures[i])});
    }
  }
  co_return result;
}

}  // namespace process
