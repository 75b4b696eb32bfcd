#include "canopen/bus/socketcan/readable.h"

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <utility>

namespace canopen::socketcan {

struct Readable::State : std::enable_shared_from_this<State> {
  State(const boost::asio::any_io_executor& executor, int number, Function to_call)
      : descriptor(executor, number), function(std::move(to_call)) {}

  void wait() {
    descriptor.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                          [weak = weak_from_this()](const boost::system::error_code& error) {
                            const std::shared_ptr<State> state = weak.lock();
                            if (!error && state) {
                              state->call();
                            }
                          });
  }

  void call() {
    const bool more = descriptor.is_open() && function();
    if (!descriptor.is_open()) {
      return;
    }
    if (!more) {
      wait();
      return;
    }
    boost::asio::post(descriptor.get_executor(), [weak = weak_from_this()] {
      if (const std::shared_ptr<State> state = weak.lock()) {
        state->call();
      }
    });
  }

  boost::asio::posix::stream_descriptor descriptor;
  Function function;
};

Readable::Readable(const boost::asio::any_io_executor& executor, Descriptor descriptor, Function function)
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
