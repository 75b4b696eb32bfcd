#pragma once

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <chrono>
#include <memory>
#include <utility>

#include "tests/support/hand_driven_loop.h"

namespace journal {

/// A loop beside which a real thread works. Time is moved by hand; what the thread has done is waited for.
class LoopWithThread {
 public:
  [[nodiscard]] support::HandDrivenLoop& hand() noexcept { return loop_; }
  [[nodiscard]] boost::asio::any_io_executor executor() { return loop_.executor(); }

  /// Until `done` says so; false where nothing came from the thread any more. Time stands still meanwhile.
  template <class Predicate>
  [[nodiscard]] bool run_until(Predicate done) {
    loop_.settle();
    while (!done()) {
      if (loop_.context().run_one_for(std::chrono::seconds(20)) == 0) {
        return false;
      }
    }
    return true;
  }

  /// Starts a coroutine; true in what it returns once that has ended.
  [[nodiscard]] std::shared_ptr<bool> start(boost::asio::awaitable<void> coroutine) {
    auto ended = std::make_shared<bool>(false);
    boost::asio::co_spawn(loop_.executor(), std::move(coroutine), [ended](std::exception_ptr) { *ended = true; });
    loop_.settle();
    return ended;
  }

 private:
  support::HandDrivenLoop loop_;
};

}  // namespace journal
