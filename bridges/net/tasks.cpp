#include "bridges/net/tasks.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <exception>
#include <utility>

namespace net {

using boost::asio::awaitable;

Tasks::Tasks(boost::asio::any_io_executor executor) : executor_(std::move(executor)), none_runs_(executor_) {}

void Tasks::spawn(awaitable<void> work, std::function<void()> ended) {
  ++running_;
  boost::asio::co_spawn(executor_, std::move(work),
                        [this, ended = std::move(ended)](const std::exception_ptr& failure) {
                          if (ended) {
                            ended();
                          }
                          if (--running_ == 0) {
                            none_runs_.cancel();
                          }
                          if (failure) {
                            std::rethrow_exception(failure);
                          }
                        });
}

awaitable<void> Tasks::all_ended() {
  while (running_ != 0) {
    boost::system::error_code ignored;
    none_runs_.expires_at(canopen::TimePoint::max());
    co_await none_runs_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, ignored));
  }
}

}  // namespace net
