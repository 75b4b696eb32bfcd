#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <functional>
#include <string>
#include <string_view>

namespace gateway {

/// Hands on each line of standard input. Input that cannot be waited for (a file, /dev/null) or that ends is no error:
/// there are just no more lines.
class LineReader {
 public:
  using Handler = std::function<void(std::string_view line)>;

  LineReader(const boost::asio::any_io_executor& executor, Handler handler);

  void start();
  /// No line comes after this.
  void stop();

  static constexpr std::size_t kLongestLine = 4096;  ///< A longer one ends the reading.

 private:
  void read();
  void hand_on();

  boost::asio::posix::stream_descriptor input_;
  Handler handler_;
  std::string buffer_;
};

}  // namespace gateway
