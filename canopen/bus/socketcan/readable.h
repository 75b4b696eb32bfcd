#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <functional>
#include <memory>

#include "canopen/bus/socketcan/descriptor.h"

namespace canopen::socketcan {

/// Owns a descriptor and calls a function each time it can be read or holds an error. Where the function returns that
/// more waits, it is called again in the next turn of the loop, without asking the kernel. It is not called after the
/// object is gone, and may destroy it.
class Readable {
 public:
  using Function = std::function<bool()>;

  Readable(const boost::asio::any_io_executor& executor, Descriptor descriptor, Function function);
  ~Readable();
  Readable(const Readable&) = delete;
  Readable& operator=(const Readable&) = delete;

  [[nodiscard]] int get() const noexcept;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace canopen::socketcan
