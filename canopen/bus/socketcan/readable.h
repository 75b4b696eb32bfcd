#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <functional>
#include <memory>

#include "canopen/bus/socketcan/descriptor.h"

namespace canopen::socketcan {

/// Owns a descriptor and calls a function each time it can be read or holds an error. The function is not called after
/// the object is gone, and may destroy it.
class Readable {
 public:
  Readable(const boost::asio::any_io_executor& executor, Descriptor descriptor, std::function<void()> function);
  ~Readable();
  Readable(const Readable&) = delete;
  Readable& operator=(const Readable&) = delete;

  [[nodiscard]] int get() const noexcept;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace canopen::socketcan
