#include "daemon/log_losses.h"

#include <boost/system/error_code.hpp>
#include <chrono>
#include <utility>

namespace gateway {
namespace {

constexpr canopen::Duration kLook = std::chrono::seconds(1);
constexpr canopen::Duration kOnceIn = std::chrono::minutes(1);

}  // namespace

LogLosses::LogLosses(const boost::asio::any_io_executor& executor, std::function<std::size_t()> dropped,
                     std::function<void(std::size_t, std::size_t)> tell)
    : dropped_(std::move(dropped)), tell_(std::move(tell)), timer_(executor) {
  watch();
}

void LogLosses::watch() {
  canopen::Duration pause = kLook;
  if (const std::size_t all = dropped_(); all != told_) {
    tell_(all - told_, all);
    told_ = all;
    pause = kOnceIn;
  }
  timer_.expires_after(pause);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      watch();
    }
  });
}

}  // namespace gateway
