#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <exception>
#include <memory>
#include <optional>
#include <utility>

namespace support {

/// A coroutine under way, and what it gave back once it ended.
template <class T>
class Spawned {
 public:
  [[nodiscard]] bool done() const noexcept { return result_->has_value(); }
  [[nodiscard]] const T& get() const { return result_->value(); }
  [[nodiscard]] const std::shared_ptr<std::optional<T>>& slot() const noexcept { return result_; }

 private:
  std::shared_ptr<std::optional<T>> result_ = std::make_shared<std::optional<T>>();
};

/// Starts `work`; an exception in it ends the test.
template <class T>
Spawned<T> spawn(const boost::asio::any_io_executor& executor, boost::asio::awaitable<T> work) {
  Spawned<T> spawned;
  boost::asio::co_spawn(executor, std::move(work), [result = spawned.slot()](std::exception_ptr failure, T value) {
    if (failure) {
      std::rethrow_exception(failure);
    }
    *result = std::move(value);
  });
  return spawned;
}

/// The same without a result.
inline std::shared_ptr<bool> spawn(const boost::asio::any_io_executor& executor, boost::asio::awaitable<void> work) {
  auto done = std::make_shared<bool>(false);
  boost::asio::co_spawn(executor, std::move(work), [done](std::exception_ptr failure) {
    if (failure) {
      std::rethrow_exception(failure);
    }
    *done = true;
  });
  return done;
}

}  // namespace support
