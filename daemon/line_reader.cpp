#include "daemon/line_reader.h"

#include <unistd.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/read_until.hpp>
#include <utility>

namespace gateway {

LineReader::LineReader(const boost::asio::any_io_executor& executor, Handler handler)
    : input_(executor), handler_(std::move(handler)) {}

void LineReader::start() {
  const int copy = ::dup(STDIN_FILENO);
  if (copy < 0) {
    return;
  }
  boost::system::error_code error;
  input_.assign(copy, error);
  if (error) {
    ::close(copy);
    return;
  }
  read();
}

void LineReader::stop() {
  boost::system::error_code ignored;
  input_.close(ignored);
}

void LineReader::read() {
  boost::asio::async_read_until(input_, boost::asio::dynamic_buffer(buffer_, kLongestLine), '\n',
                                [this](const boost::system::error_code& error, std::size_t /*length*/) {
                                  if (error) {
                                    return;
                                  }
                                  hand_on();
                                  read();
                                });
}

void LineReader::hand_on() {
  for (std::size_t end = buffer_.find('\n'); end != std::string::npos; end = buffer_.find('\n')) {
    const std::string line = buffer_.substr(0, end);
    buffer_.erase(0, end + 1);
    handler_(line);
  }
}

}  // namespace gateway
