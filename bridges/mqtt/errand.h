#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <future>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

namespace mqtt {

/// Work that may hang for long, such as a name server's: in a thread of its own, which owns all that it uses, so that
/// it can be left to itself. One at a time. What throws came to T(). Not thread-safe.
template <class T>
class Errand {
 public:
  /// False: no thread is to be had.
  bool start(std::function<T()> work) {
    std::packaged_task<Done()> task([to_do = std::move(work)] {
      T result{};
      try {
        result = to_do();
      } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): it came to nothing
      }
      return Done{std::move(result), std::chrono::steady_clock::now()};
    });
    std::future<Done> result = task.get_future();
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
    return result_.get().result;
  }

  /// What came of it more than `age` ago is not to be had any more: another one may be begun.
  void forget_older(std::chrono::milliseconds age) {
    if (result_.valid() && result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
      Done done = result_.get();
      if (std::chrono::steady_clock::now() - done.at <= age) {
        std::promise<Done> again;
        again.set_value(std::move(done));
        result_ = again.get_future();
      }
    }
  }
  /// Nobody wants to know any more what comes of it.
  void forget() { result_ = {}; }

 private:
  struct Done {
    T result;
    std::chrono::steady_clock::time_point at;  ///< When it ended.
  };
  std::future<Done> result_;
};

}  // namespace mqtt
