#include "canopen/bus/socketcan/readable.h"

#include <boost/asio/posix/stream_descriptor.hpp>

namespace canopen::socketcan {

struct Readable::State : std::enable_shared_from_this<State> {
  State(const boost::asio::any_io_executor& executor, int number, std::function<void()> to_call)
      : descriptor(executor, number), function(std::move(to_call)) {}

  void wait() {
    descriptor.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                          [weak = weak_from_this()](const boost::system::error_code& error) {
                            const std::shared_ptr<State> state = weak.lock();
                            if (error || !state || !state->descriptor.is_open()) {
                              return;
                            }
                            state->function();
                            if (state->descriptor.is_open()) {
                              state->wait();
                            }
                          });
  }

  boost::asio::posix::stream_descriptor descriptor;
  std::function<void()> function;
};

Readable::Readable(const boost::asio::any_io_executor& executor, Descriptor descriptor, std::function<void()> function)
    : state_(std::make_shared<State>(executor, descriptor.get(), std::move(function))) {
  descriptor.release();  // Asio closes it from here on.
  state_->wait();
}

Readable::~Readable() {
  boost::system::error_code ignored;
  state_->descriptor.close(ignored);
}

int Readable::get() const noexcept {
  return state_->descriptor.native_handle();
}

}  // namespace canopen::socketcan
