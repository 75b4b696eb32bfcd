#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

namespace mqtt {

/// Work that may hang for long, such as a name server's: in a thread of its own, which owns all that it uses, so that
/// it can be left to itself. One at a time. Not thread-safe.
template <class T>
class Errand {
 public:
  /// False: no thread is to be had.
  bool start(std::function<T()> work) {
    std::packaged_task<T()> task(std::move(work));
    std::future<T> result = task.get_future();
    try {
      std::thread(std::move(task)).detach();
    } catch (const std::system_error&) {
      return false;
    }
    result_ = std::move(result);
    return true;
  }

  [[nodiscard]] bool runs() const noexcept { return result_.valid(); }

  /// What came of it, once. Nothing: it runs still, after `patience` too, or none was begun.
  [[nodiscard]] std::optional<T> take(std::chrono::milliseconds patience = {}) {
    if (!result_.valid() || result_.wait_for(patience) != std::future_status::ready) {
      return std::nullopt;
    }
    return result_.get();
  }

 private:
  std::future<T> result_;
};

}  // namespace mqtt
