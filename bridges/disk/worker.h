#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <functional>
#include <memory>
#include <thread>

namespace disk {

/// A thread for what may hang: does one job at a time beside the loop. A job, and all that it uses, is its own: where
/// it hangs at the end of the process it is left behind.
class Worker {
 public:
  explicit Worker(boost::asio::any_io_executor executor);
  /// Waits for the job under way for at most a second.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Only while none is under way. `done` is called on the loop, unless the worker is gone by then.
  void run(std::function<void()> job, std::function<void()> done);
  [[nodiscard]] bool busy() const noexcept { return busy_; }

 private:
  struct Shared;
  static void work(const std::shared_ptr<Shared>& shared);

  bool busy_ = false;               ///< On the loop: done() was not called yet.
  std::shared_ptr<Shared> shared_;  ///< With the thread, which may outlive us.
  std::thread thread_;
};

}  // namespace disk
