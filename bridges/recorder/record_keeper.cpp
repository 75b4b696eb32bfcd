#include "bridges/recorder/record_keeper.h"

#include <algorithm>
#include <utility>

namespace recorder {

using canopen::Clock;

RecordKeeper::RecordKeeper(const boost::asio::any_io_executor& executor, KeptAt at, disk::Trouble::Told told)
    : store_(std::make_shared<RecordStore>(at.state_directory, at.keep, std::move(at.calls))),
      directory_(store_->directory()),
      told_(std::move(told)),
      trouble_(told_),
      time_(executor, [this] { on_time(); }),
      progress_(executor),
      worker_(executor) {}

void RecordKeeper::start(Handlers handlers) {
  handlers_ = std::move(handlers);
  look_ = true;
  on_time();
}

void RecordKeeper::post(Record record) {
  // The first of a bus is under way, or tried again; a second may wait, and that is all the memory they get.
  const auto of_bus =
      std::ranges::count_if(waiting_, [&record](const Waiting& waiting) { return waiting.record->bus == record.bus; });
  std::string stem = to_text(record.name);
  waiting_.push_back({std::make_shared<const Record>(std::move(record)), std::move(stem), Clock::now()});
  if (of_bus >= 2) {
    give_up(std::prev(waiting_.end()), "those before it are not on the disk yet");
  }
  on_time();
}

void RecordKeeper::look() {
  look_ = !stopping_;
  on_time();
}

// Asked for every alarm that names a record, after each write: no text is made, and no list is walked.
bool RecordKeeper::knows(std::string_view stem) const {
  const auto waits = [stem](const Waiting& waiting) { return waiting.stem == stem; };
  return std::ranges::any_of(waiting_, waits) || (records_ && records_->find(stem) != nullptr);
}

void RecordKeeper::give_up(std::deque<Waiting>::iterator record, const std::string& why) {
  ++lost_;
  told_("record " + record->stem + " is lost: " + why);
  waiting_.erase(record);
}

void RecordKeeper::on_time() {
  const canopen::TimePoint now = Clock::now();
  if (worker_.busy()) {  // Its end leads here again.
    tell_if_slow(now);
    return;
  }
  if (waiting_.empty() && !look_) {
    return;
  }
  if (retry_ && *retry_ > now) {
    time_.arm(*retry_);
    return;
  }
  begin(now);
}

void RecordKeeper::tell_if_slow(canopen::TimePoint now) {
  if (now < *begun_ + kSlow) {
    time_.arm_no_later_than(*begun_ + kSlow);
  } else {
    trouble_.stands(directory_.string() + " does not answer; records are not kept meanwhile", now);
  }
}

bool RecordKeeper::works() const noexcept {
  const bool slow = worker_.busy() && begun_ && Clock::now() >= *begun_ + kSlow;
  return !slow && !retry_ && !refuses_records_;
}

void RecordKeeper::begin(canopen::TimePoint now) {
  begun_ = now;
  look_ = false;
  writing_ = !waiting_.empty();
  const auto written = std::make_shared<Written>();
  const std::shared_ptr<const Record> record = writing_ ? waiting_.front().record : nullptr;
  worker_.run(
      [written, store = store_, record] {
        written->failure = record ? store->write(*record) : store->open();
        if (store->is_open()) {
          written->records = store->records();
        }
      },
      [this, written] { on_written(*written); });
  tell_if_slow(now);
}

void RecordKeeper::on_written(Written& written) {
  const canopen::TimePoint now = Clock::now();
  records_ = std::move(written.records);
  const bool was_record = std::exchange(writing_, false);
  if (written.failure) {
    note_failure(*written.failure, was_record, now);
  } else {
    note_success(was_record);
  }
  handlers_.changed();
  progress_.notify();
  if (stopping_) {
    retry_.reset();
    look_ = false;
  }
  on_time();
}

void RecordKeeper::note_success(bool was_record) {
  retry_.reset();
  refuses_records_ = refuses_records_ && !was_record;
  if (!refuses_records_) {
    trouble_.is_over("records are kept again in " + directory_.string());
  }
  if (was_record) {
    const std::shared_ptr<const Record> record = waiting_.front().record;
    waiting_.pop_front();
    handlers_.kept(*record);
  }
}

void RecordKeeper::note_failure(const std::string& why, bool was_record, canopen::TimePoint now) {
  refuses_records_ = refuses_records_ || (was_record && records_);
  trouble_.stands(why + "; records are not kept meanwhile", now);
  retry_ = now + kTryAgain;
  if (was_record && (stopping_ || now - waiting_.front().since >= kGiveUp)) {
    give_up(waiting_.begin(), why);
  }
  look_ = waiting_.empty();
}

boost::asio::awaitable<void> RecordKeeper::stop() {
  const canopen::TimePoint until = Clock::now() + std::chrono::seconds(1);
  stopping_ = true;
  look_ = false;
  retry_.reset();
  on_time();
  while ((worker_.busy() || !waiting_.empty()) && Clock::now() < until) {
    co_await progress_.wait_until(until);
  }
  while (!waiting_.empty()) {
    give_up(waiting_.begin(), directory_.string() + " does not answer");
  }
  writing_ = false;
  time_.cancel();
}

}  // namespace recorder
