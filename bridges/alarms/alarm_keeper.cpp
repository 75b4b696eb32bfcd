#include "bridges/alarms/alarm_keeper.h"

#include <algorithm>
#include <chrono>
#include <future>
#include <string>
#include <utility>

namespace alarms {
namespace {

using canopen::Clock;
using canopen::kNever;

struct Loaded {
  AlarmMemory memory;
  MemoryFile::Failure failure;
  bool usable = true;  ///< The directory is ours.
};

Loaded load_from(MemoryFile& file) {
  if (MemoryFile::Failure failure = file.open()) {
    return {{}, std::move(failure), false};
  }
  std::optional<std::string> text;
  MemoryFile::Failure failure = file.read(text);
  if (!failure && !text) {
    return {};
  }
  ReadMemory read = failure ? ReadMemory{} : parse_memory(*text);
  if (!failure && read.wrong.empty()) {
    return {std::move(read.memory), std::nullopt, true};
  }
  std::string told = failure.value_or(std::string(MemoryFile::kName) + ": " + read.wrong);
  const MemoryFile::Failure not_aside = file.set_aside();
  told += not_aside ? "; " + *not_aside : "; it is now " + std::string(MemoryFile::kBadName);
  return {{}, told + ", and nothing is known of alarms before this start", true};
}

}  // namespace

AlarmKeeper::AlarmKeeper(const boost::asio::any_io_executor& executor, const KeptAt& at, disk::Trouble::Told told)
    : file_(std::make_shared<MemoryFile>(at.directory, at.calls)),
      directory_(at.directory),
      load_patience_(at.load_patience),
      told_(std::move(told)),
      trouble_(told_),
      worker_(executor),
      time_(executor, [this] { on_time(); }),
      progress_(executor) {}

AlarmMemory AlarmKeeper::load() {
  const auto promise = std::make_shared<std::promise<Loaded>>();
  std::future<Loaded> loaded = promise->get_future();
  worker_.run([promise, file = file_] { promise->set_value(load_from(*file)); }, [this] { on_time(); });
  if (loaded.wait_for(load_patience_) != std::future_status::ready) {
    trouble_.stands(directory_.string() + " does not answer; nothing is known of alarms before this start",
                    Clock::now());
    return {};
  }
  Loaded result = loaded.get();
  if (result.failure && result.usable) {
    told_(*result.failure);
  } else if (result.failure) {
    trouble_.stands(*result.failure + "; alarms are not kept meanwhile", Clock::now());
  }
  return std::move(result.memory);
}

void AlarmKeeper::start(std::function<AlarmMemory()> snapshot) {
  snapshot_ = std::move(snapshot);
}

void AlarmKeeper::on_begin_or_end() {
  want(Clock::now());
}

void AlarmKeeper::on_change() {
  want(begun_ ? *begun_ + kPause : Clock::now());
}

void AlarmKeeper::want(canopen::TimePoint at) {
  due_ = std::min(due_, at);
  time_.arm_no_later_than(due_);
}

void AlarmKeeper::on_time() {
  const canopen::TimePoint now = Clock::now();
  if (worker_.busy()) {  // Its end leads here again.
    tell_if_slow(now);
    return;
  }
  if (due_ == kNever || !snapshot_) {
    return;
  }
  canopen::TimePoint at = std::max(due_, retry_.value_or(due_));
  if (begun_) {
    at = std::max(at, *begun_ + kSpacing);
  }
  if (at > now) {
    time_.arm(at);
  } else {
    write(now);
  }
}

void AlarmKeeper::tell_if_slow(canopen::TimePoint now) {
  if (!begun_) {
    return;  // What hangs is load(), which told it.
  }
  if (now < *begun_ + kSlow) {
    time_.arm(*begun_ + kSlow);
  } else {
    trouble_.stands(directory_.string() + " does not answer; alarms are not kept meanwhile", now);
  }
}

void AlarmKeeper::write(canopen::TimePoint now) {
  begun_ = now;
  due_ = kNever;
  const auto failure = std::make_shared<MemoryFile::Failure>();
  worker_.run([failure, file = file_, memory = snapshot_()] { *failure = file->write(memory_text(memory)); },
              [this, failure] { on_written(*failure); });
  tell_if_slow(now);
}

void AlarmKeeper::on_written(const MemoryFile::Failure& failure) {
  const canopen::TimePoint now = Clock::now();
  if (!failure) {
    retry_.reset();
    trouble_.is_over("alarms are kept again in " + directory_.string());
  } else if (stopping_) {
    due_ = kNever;
    told_(*failure + "; the last changes of alarms are not kept");
  } else {
    trouble_.stands(*failure + "; alarms are not kept meanwhile", now);
    due_ = std::min(due_, now);
    retry_ = now + kTryAgain;
  }
  progress_.notify();
  on_time();
}

boost::asio::awaitable<void> AlarmKeeper::stop() {
  const canopen::TimePoint until = Clock::now() + std::chrono::seconds(1);
  stopping_ = true;
  retry_.reset();
  if (due_ != kNever) {
    want(Clock::now());
  }
  while ((worker_.busy() || due_ != kNever) && Clock::now() < until) {
    co_await progress_.wait_until(until);
  }
  if (worker_.busy() || due_ != kNever) {
    told_(directory_.string() + " does not answer; the last changes of alarms are not kept");
  }
  snapshot_ = nullptr;
  time_.cancel();
}

}  // namespace alarms
