#include "daemon/line_reader.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

#include "daemon/terminal.h"

namespace gateway {

LineReader::LineReader(const boost::asio::any_io_executor& executor, Handler handler)
    : input_(executor), later_(executor), handler_(std::move(handler)) {}

LineReader::~LineReader() {
  stop();
}

void LineReader::start() {
  int own = reopen(STDIN_FILENO, O_RDONLY);
  if (own < 0) {
    shared_flags_ = ::fcntl(STDIN_FILENO, F_GETFL);
    own = ::dup(STDIN_FILENO);
  }
  if (own < 0) {
    return;
  }
  boost::system::error_code error;
  input_.assign(own, error);
  if (error) {
    ::close(own);
    return;
  }
  input_.non_blocking(true, error);
  wait();
}

void LineReader::stop() {
  later_.cancel();
  boost::system::error_code ignored;
  input_.close(ignored);
  if (const int flags = std::exchange(shared_flags_, -1); flags >= 0) {
    ::fcntl(STDIN_FILENO, F_SETFL, flags);
  }
}

void LineReader::wait() {
  input_.async_wait(boost::asio::posix::stream_descriptor::wait_read, [this](const boost::system::error_code& error) {
    if (error) {
      return;
    }
    if (may_read_terminal(input_.native_handle())) {
      take();
    } else {
      look_later();
    }
  });
}

void LineReader::look_later() {
  later_.expires_after(kLook);
  later_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      wait();
    }
  });
}

void LineReader::take() {
  std::array<char, kLongestLine> bytes{};
  const ssize_t length = ::read(input_.native_handle(), bytes.data(), bytes.size());
  if (length > 0) {
    buffer_.append(bytes.data(), static_cast<std::size_t>(length));
    hand_on();
    if (input_.is_open() && buffer_.size() < kLongestLine) {
      wait();
    }
  } else if (length < 0 && (errno == EAGAIN || errno == EINTR)) {
    wait();
  } else if (length < 0 && errno == EIO && !may_read_terminal(input_.native_handle())) {
    look_later();  // It was put into the background just now.
  }
}

void LineReader::hand_on() {
  for (std::size_t end = buffer_.find('\n'); end != std::string::npos; end = buffer_.find('\n')) {
    const std::string line = buffer_.substr(0, end);
    buffer_.erase(0, end + 1);
    if (line.size() >= kLongestLine) {
      buffer_.assign(kLongestLine, ' ');  // The reading ends here, as it would have before the line's end came.
      return;
    }
    handler_(line);
  }
}

}  // namespace gateway
