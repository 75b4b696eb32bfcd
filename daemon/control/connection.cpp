#include "daemon/control/connection.h"

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/system/error_code.hpp>
#include <utility>

#include "daemon/control/answer.h"

namespace gateway::control {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::asio::local::stream_protocol;
using boost::system::error_code;

Connection::Connection(stream_protocol::socket socket, std::string user, const Service& service, http::LoopShare& share)
    : socket_(std::move(socket)),
      user_(std::move(user)),
      service_(service),
      share_(share),
      turn_(socket_.get_executor()),
      tasks_(socket_.get_executor()),
      active_(canopen::Clock::now()) {}

canopen::TimePoint Connection::idle_since() const noexcept {
  return under_way_ > 0 || (writing_ && !streams_) || !socket_.is_open() ? canopen::TimePoint::max() : active_;
}

void Connection::take_no_more() {
  error_code ignored;  // It is gone already.
  socket_.shutdown(stream_protocol::socket::shutdown_receive, ignored);
  ending_ = true;
  turn_.cancel();
}

void Connection::close() {
  error_code ignored;  // It is gone either way.
  socket_.shutdown(stream_protocol::socket::shutdown_both, ignored);
  socket_.close(ignored);
  waiting_.clear();
  turn_.cancel();
}

awaitable<void> Connection::serve() {
  co_await read_lines();
  co_await tasks_.all_ended();
  close();
}

awaitable<void> Connection::read_lines() {
  std::array<char, 4096> buffer{};
  for (;;) {
    error_code failed;
    const std::size_t count =
        co_await socket_.async_read_some(boost::asio::buffer(buffer), redirect_error(use_awaitable, failed));
    if (failed) {
      break;
    }
    active_ = canopen::Clock::now();
    // Of all lines in it: others are served between two of them.
    read_at_ = active_;
    received_.append(buffer.data(), count);
    co_await begin_whole_lines();
    if (received_.size() > kMaxLine) {
      if (!skipping_) {
        send(refusal("null", too_long()));
      }
      skipping_ = true;
      received_.clear();
    }
  }
  // The last line may go without an end; one that was cut off is no valid JSON.
  if (!skipping_ && socket_.is_open()) {
    begin(received_);
  }
}

awaitable<void> Connection::begin_whole_lines() {
  std::size_t begin_of_line = 0;
  for (std::size_t end = received_.find('\n'); end != std::string::npos && socket_.is_open();
       end = received_.find('\n', begin_of_line)) {
    if (!std::exchange(skipping_, false)) {
      begin(std::string_view(received_).substr(begin_of_line, end - begin_of_line));
    }
    begin_of_line = end + 1;
    // Whoever sends many at once does not keep the bus waiting.
    co_await boost::asio::post(socket_.get_executor(), use_awaitable);
  }
  received_.erase(0, begin_of_line);
}

void Connection::begin(std::string_view text) {
  if (text.find_first_not_of(" \t\r") == std::string_view::npos) {
    return;
  }
  if (text.size() > kMaxLine) {
    send(refusal("null", too_long()));
    return;
  }
  Line line = parse_line(text);
  if (line.request.has_error()) {
    send(refusal(line.id, line.request.error()));
    return;
  }
  if (under_way_ >= kMaxUnderWay && !service_.is_stop(line.request.value())) {
    send(refusal(line.id, {.kind = canopen::ErrorKind::timeout,
                           .not_sent = true,
                           .detail = "too many requests under way; this one was not carried out"}));
    return;
  }
  if (is_stream(line.request.value())) {
    begin_stream(line);
    return;
  }
  ++under_way_;
  tasks_.spawn(carry_out(
      {.request = std::move(line.request.value()), .id = std::move(line.id), .user = user_, .received = read_at_}));
}

awaitable<void> Connection::carry_out(Asked asked) {
  const std::string answer = co_await service_.answer(std::move(asked));
  --under_way_;
  send(answer);
}

void Connection::send(std::string_view answer) {
  send_lines(std::string(answer) + '\n');
}

void Connection::send_lines(std::string_view lines) {
  if (!socket_.is_open() || lines.empty()) {
    return;
  }
  if (waiting_.size() + leaving_ + lines.size() > kMaxWaiting + piece_) {
    close();
    return;
  }
  waiting_.append(lines);
  if (!std::exchange(writing_, true)) {
    tasks_.spawn(write_answers());
  }
}

awaitable<void> Connection::write_answers() {
  while (!waiting_.empty() && socket_.is_open()) {
    const std::string leaving = std::exchange(waiting_, {});
    leaving_ = leaving.size();
    error_code failed;
    co_await boost::asio::async_write(socket_, boost::asio::buffer(leaving), redirect_error(use_awaitable, failed));
    leaving_ = 0;
    active_ = canopen::Clock::now();
    if (failed) {
      close();
    }
  }
  writing_ = false;
}

}  // namespace gateway::control
