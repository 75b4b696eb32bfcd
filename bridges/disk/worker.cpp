#include "bridges/disk/worker.h"

#include <pthread.h>

#include <boost/asio/post.hpp>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <optional>
#include <utility>

namespace disk {

struct Worker::Shared {
  std::mutex mutex;
  std::condition_variable changed;
  std::optional<boost::asio::any_io_executor> executor;  ///< Nothing: the loop may be gone.
  std::function<void()> job;
  std::function<void()> done;
  bool ended = false;  ///< The thread does nothing any more.
};

Worker::Worker(boost::asio::any_io_executor executor) : shared_(std::make_shared<Shared>()) {
  shared_->executor = std::move(executor);
  // Signals of the process are the loop's.
  sigset_t all{};
  sigset_t before{};
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([shared = shared_] { work(shared); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Worker::~Worker() {
  std::unique_lock lock(shared_->mutex);
  shared_->executor.reset();
  shared_->changed.notify_all();
  const bool ended = shared_->changed.wait_for(lock, std::chrono::seconds(1), [this] { return shared_->ended; });
  lock.unlock();
  if (ended) {
    thread_.join();
  } else {
    thread_.detach();
  }
}

void Worker::run(std::function<void()> job, std::function<void()> done) {
  busy_ = true;
  const std::lock_guard lock(shared_->mutex);
  shared_->job = std::move(job);
  shared_->done = [this, done = std::move(done)] {
    busy_ = false;
    done();
  };
  shared_->changed.notify_all();
}

void Worker::work(const std::shared_ptr<Shared>& shared) {
  std::unique_lock lock(shared->mutex);
  for (;;) {
    shared->changed.wait(lock, [&] { return shared->job || !shared->executor; });
    if (!shared->executor) {
      break;
    }
    const std::function<void()> job = std::exchange(shared->job, nullptr);
    lock.unlock();
    job();
    lock.lock();
    if (shared->executor) {
      boost::asio::post(*shared->executor, [shared] {
        std::unique_lock guard(shared->mutex);
        if (shared->executor) {  // else the worker is gone
          const std::function<void()> done = std::exchange(shared->done, nullptr);
          guard.unlock();
          done();
        }
      });
    }
  }
  shared->ended = true;
  shared->changed.notify_all();
}

}  // namespace disk
