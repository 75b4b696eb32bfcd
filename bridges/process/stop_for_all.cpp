#include "bridges/process/stop_for_all.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <exception>
#include <utility>

#include "bridges/process/command_checks.h"

namespace process {
namespace {

boost::asio::awaitable<void> stop_one(Drive& drive, Origin origin, Outcome& outcome) {
  outcome = co_await drive.stop_motor(std::move(origin));
}

}  // namespace

boost::asio::awaitable<std::vector<Stopped>> stop_for_all(Plant& plant, Origin origin) {
  const auto executor = co_await boost::asio::this_coro::executor;
  std::vector<Drive*> drives;
  for (std::size_t i = 0; i < plant.size(); ++i) {
    if (!refuse_writer(plant.drive(i).model(), origin.writer)) {
      drives.push_back(&plant.drive(i));
    }
  }
  std::vector<Stopped> stopped(drives.size());
  std::size_t under_way = drives.size();
  canopen::Timer all_ended(executor);
  for (std::size_t i = 0; i < drives.size(); ++i) {
    stopped[i].drive = drives[i];
    boost::asio::co_spawn(executor, stop_one(*drives[i], origin, stopped[i].outcome),
                          [&under_way, &all_ended](const std::exception_ptr& failure) {
                            if (--under_way == 0) {
                              all_ended.cancel();
                            }
                            if (failure) {
                              std::rethrow_exception(failure);
                            }
                          });
  }
  while (under_way != 0) {
    boost::system::error_code ignored;
    all_ended.expires_at(canopen::kNever);
    co_await all_ended.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, ignored));
  }
  co_return stopped;
}

}  // namespace process
