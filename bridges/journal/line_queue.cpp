#include "bridges/journal/line_queue.h"

#include <algorithm>
#include <utility>

namespace journal {
namespace {

constexpr std::chrono::seconds kSyncPeriod(1);
constexpr std::size_t kMostAtOnce = 64;
// What a line takes beside its members.
constexpr std::size_t kOverhead = 200;

}  // namespace

/// What the writing thread is given, and what became of it.
struct LineQueue::Batch {
  std::vector<Entry> entries;
  std::size_t written = 0;
  Store::Failure failure;
  std::string newest_hash;
  std::vector<std::string> lines;  ///< As they stand on the disk.
};

LineQueue::LineQueue(const boost::asio::any_io_executor& executor, const Place& place, disk::Trouble::Told told)
    : directory_(place.directory),
      most_waiting_(place.waiting),
      trouble_(std::move(told)),
      store_(std::make_shared<Store>(place.directory, place.limit, place.calls)),
      writer_(executor),
      syncer_(executor),
      progress_(executor),
      tick_(executor, [this] { on_tick(); }) {}

void LineQueue::start() {
  const auto batch = std::make_shared<Batch>();
  const auto open = [store = store_, directory = directory_, batch,
                     now = Entry{canopen::wall_now(), canopen::Clock::now(), {}}] {
    batch->failure = store->open(now);
    batch->newest_hash = store->newest_hash();
    batch->lines = read_newest_lines(directory);
  };
  writer_.run(open, [this, batch] { on_written(*batch); });
}

std::uint64_t LineQueue::post(Entry entry) {
  const std::uint64_t number = ++posted_;
  if (waiting_bytes_ + entry.members.size() + kOverhead > most_waiting_) {
    ++lost_;
    ++lost_untold_;
    return number;
  }
  tell_lost();
  push(std::move(entry), number);
  return number;
}

boost::asio::awaitable<void> LineQueue::written(std::uint64_t number) {
  // Who waits for the first line behind which others wait has waited for all of them.
  const canopen::TimePoint until = waiting_.empty() ? canopen::Clock::now() : waiting_.front().since + kPatience;
  while (done_ < number && !refused_ && canopen::Clock::now() < until) {
    co_await progress_.wait_until(until);
  }
  if (done_ >= number) {
    co_return;
  }
  ++passed_by_;
  if (!refused_) {
    trouble_.stands("the disk takes longer than 50 ms; commands do not wait for their lines", canopen::Clock::now());
  }
}

boost::asio::awaitable<void> LineQueue::until_synced(canopen::TimePoint until) {
  while (!refused_ && canopen::Clock::now() < until &&
         (!waiting_.empty() || writer_.busy() || syncer_.busy() || unsynced_)) {
    if (waiting_.empty() && !writer_.busy()) {
      sync();
    }
    co_await progress_.wait_until(until);
  }
}

void LineQueue::push(Entry entry, std::uint64_t number) {
  refused_ = refused_ && !waiting_.empty();
  waiting_bytes_ += entry.members.size() + kOverhead;
  waiting_.push_back({std::move(entry), number, canopen::Clock::now()});
  tick_.arm_no_later_than(canopen::Clock::now() + kSyncPeriod);
  if (!refused_) {
    write_next();
  }
}

void LineQueue::tell_lost() {
  if (lost_untold_ > 0) {
    const std::uint64_t count = std::exchange(lost_untold_, 0);
    push({canopen::wall_now(), canopen::Clock::now(), "\"phase\":\"lost\",\"count\":" + std::to_string(count)}, 0);
  }
}

void LineQueue::write_next() {
  if (writer_.busy() || waiting_.empty()) {
    return;
  }
  const auto batch = std::make_shared<Batch>();
  for (std::size_t i = 0; i < std::min(waiting_.size(), kMostAtOnce); ++i) {
    batch->entries.push_back(waiting_[i].entry);
  }
  const auto write = [store = store_, batch] {
    for (const Entry& entry : batch->entries) {
      batch->failure = store->append(entry);
      if (batch->failure) {
        break;
      }
      ++batch->written;
      batch->lines.push_back(store->newest_line().substr(0, store->newest_line().size() - 1));
    }
    batch->newest_hash = store->newest_hash();
  };
  writer_.run(write, [this, batch] { on_written(*batch); });
}

void LineQueue::on_written(Batch& batch) {
  for (std::string& line : batch.lines) {
    newest_lines_.add(std::move(line));
  }
  for (std::size_t i = 0; i < batch.written; ++i) {
    waiting_bytes_ -= waiting_.front().entry.members.size() + kOverhead;
    done_ = std::max(done_, waiting_.front().number);
    waiting_.pop_front();
  }
  newest_hash_ = batch.newest_hash;
  unsynced_ = unsynced_ || batch.written > 0;
  refused_ = batch.failure.has_value();
  if (refused_) {
    trouble_.stands(*batch.failure + "; commands go on without the journal", canopen::Clock::now());
  } else {
    tell_lost();
    write_next();
    if (waiting_.empty()) {
      trouble_.is_over(summary());
    }
  }
  progress_.notify();
}

void LineQueue::sync() {
  if (syncer_.busy() || !std::exchange(unsynced_, false)) {
    return;
  }
  const auto failure = std::make_shared<Store::Failure>();
  syncer_.run([store = store_, failure] { *failure = store->sync(); },
              [this, failure] {
                if (*failure) {
                  trouble_.stands(**failure, canopen::Clock::now());
                }
                progress_.notify();
              });
}

void LineQueue::on_tick() {
  write_next();
  sync();
  if (!waiting_.empty() || unsynced_) {
    tick_.arm_no_later_than(canopen::Clock::now() + kSyncPeriod);
  }
}

std::string LineQueue::summary() const {
  return "works again; " + std::to_string(passed_by_) + " commands did not wait for their line, " +
         std::to_string(lost_) + " lines were lost";
}

}  // namespace journal
