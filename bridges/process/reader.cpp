#include "bridges/process/reader.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <exception>
#include <utility>

#include "bridges/process/error_check.h"
#include "canopen/node/remote_node.h"

namespace process {
namespace {

/// Pause before a drive that did not answer is asked for its errors again, and where it goes on not answering.
constexpr canopen::Duration kCheckAgain = std::chrono::seconds(1);
constexpr canopen::Duration kCheckSeldom = std::chrono::seconds(10);
/// Checks are no more frequent, however often frames are lost or emergencies come: polls have their turn between.
constexpr canopen::Duration kCheckPause = std::chrono::seconds(1);

}  // namespace

Reader::Reader(boost::asio::any_io_executor executor, const config::Drive& model, canopen::RemoteNode& node,
               Inputs& inputs, alarms::DriveAlarms& alarms)
    : executor_(std::move(executor)),
      model_(model),
      node_(node),
      inputs_(inputs),
      alarms_(alarms),
      changed_(executor_) {}

void Reader::start() {
  running_ = true;
  boost::asio::co_spawn(executor_, run(), [this](std::exception_ptr failure) {
    running_ = false;
    changed_.notify();
    if (failure) {
      std::rethrow_exception(failure);
    }
  });
}

boost::asio::awaitable<void> Reader::stop() {
  stopping_ = true;
  changed_.notify();
  while (running_) {
    co_await changed_.wait_until(canopen::TimePoint::max());
  }
}

void Reader::check_errors() {
  check_at_ = std::max(canopen::Clock::now(), not_before_);
  changed_.notify();
}

void Reader::forget_errors() {
  check_at_ = canopen::TimePoint::max();
  not_before_ = canopen::TimePoint::min();
  watch_.forget_silence();
}

void Reader::watch_errors() {
  const std::optional<canopen::TimePoint> since = alarms_.error_list().undecided_since();
  if (std::exchange(undecided_since_, since) != since) {
    changed_.notify();
  }
}

boost::asio::awaitable<void> Reader::run() {
  while (!stopping_) {
    const canopen::TimePoint now = canopen::Clock::now();
    if (check_at_ <= now) {
      co_await read_errors();
    } else if (watch_at() <= now) {
      co_await read_error_register();
    } else if (const std::optional<ReadJob> job = inputs_.next_read(now)) {
      co_await read(*job);
    } else {
      const canopen::TimePoint next = std::min({check_at_, watch_at(), inputs_.next_read_at()});
      co_await changed_.wait_until(next);
    }
  }
}

boost::asio::awaitable<void> Reader::read_errors() {
  check_at_ = canopen::TimePoint::max();
  not_before_ = canopen::Clock::now() + kCheckPause;
  const std::uint32_t emergencies = alarms_.error_list().received();
  const bool online = node_.status().online;
  const ErrorCheck check = co_await process::check_errors(model_, node_);
  if (stopping_ || node_.status().online != online) {
    co_return;
  }
  const canopen::TimePoint now = canopen::Clock::now();
  watch_.on_read(now, !check.again);
  if (alarms_.error_list().received() != emergencies) {
    // An emergency came meanwhile, which these answers may not know of.
    check_at_ = std::min(check_at_, std::max(now, not_before_));
    co_return;
  }
  alarms_.on_readings(check.readings, now, canopen::wall_now());
  watch_errors();
  if (check.again && online) {
    check_at_ = std::min(check_at_, now + (watch_.silent() ? kCheckSeldom : kCheckAgain));
  }
}

boost::asio::awaitable<void> Reader::read_error_register() {
  const std::uint32_t emergencies = alarms_.error_list().received();
  const ErrorCheck check = co_await check_error_register(node_);
  const canopen::TimePoint now = canopen::Clock::now();
  watch_.on_read(now, !check.again);
  if (stopping_ || !node_.status().online || alarms_.error_list().received() != emergencies) {
    co_return;
  }
  alarms_.on_error_register(check.readings, now, canopen::wall_now());
  watch_errors();
}

boost::asio::awaitable<void> Reader::read(ReadJob job) {
  const canopen::Result<canopen::Raw> answer = co_await node_.read(job.object, job.type, job.due);
  if (!stopping_) {
    inputs_.on_read(job, answer, canopen::Clock::now(), canopen::wall_now());
  }
}

}  // namespace process
