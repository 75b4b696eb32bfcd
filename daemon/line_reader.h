#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <functional>
#include <string>
#include <string_view>

#include "canopen/clock.h"

namespace gateway {

/// Hands on each line of standard input. Input that cannot be waited for (a file, /dev/null) or that ends is no error:
/// there are just no more lines. A terminal is read only while this program is in its foreground.
class LineReader {
 public:
  using Handler = std::function<void(std::string_view line)>;

  LineReader(const boost::asio::any_io_executor& executor, Handler handler);
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  void start();
  /// No line comes after this; standard input is as it was.
  void stop();

  static constexpr std::size_t kLongestLine = 4096;  ///< A longer one ends the reading.
  /// How soon it is noticed that the program came back into the foreground.
  static constexpr canopen::Duration kLook = std::chrono::milliseconds(500);

 private:
  void wait();
  void look_later();
  void take();
  void hand_on();

  boost::asio::posix::stream_descriptor input_;
  canopen::Timer later_;
  Handler handler_;
  std::string buffer_;
  int shared_flags_ = -1;  ///< Of standard input, where it could not be opened anew.
};

}  // namespace gateway
