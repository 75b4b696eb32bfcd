// A stream of a connection: its lines leave in turns with those of all others.

#include <poll.h>

#include <boost/asio/ip/address.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <string>
#include <utility>

#include "daemon/control/answer.h"
#include "daemon/control/connection.h"

namespace gateway::control {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::system::error_code;

void Connection::begin_stream(const Line& line) {
  if (streams_ || !service_.open_stream) {
    send(refusal(line.id, {.kind = canopen::ErrorKind::forbidden,
                           .detail = "a connection has one stream at a time; ask on another one"}));
    return;
  }
  if (line.id.size() > kMaxStreamId) {
    send(refusal(line.id, {.kind = canopen::ErrorKind::type,
                           .detail = "the \"id\" of a stream, which is in each of its lines, is longer than " +
                                     std::to_string(kMaxStreamId) + " bytes"}));
    return;
  }
  canopen::Result<std::unique_ptr<Stream>> opened = service_.open_stream(line.request.value(), line.id);
  if (opened.has_error()) {
    send(refusal(line.id, opened.error()));
    return;
  }
  streams_ = true;
  send("{\"id\":" + line.id + ",\"ok\":true,\"stream\":true}");
  tasks_.spawn(tell_stream(line.id, std::move(opened.value())));
}

awaitable<void> Connection::tell_stream(std::string id, std::unique_ptr<Stream> stream) {
  while (may_tell()) {
    const bool more = co_await tell_piece(*stream);
    if (hung_up()) {
      close();
    }
    if (!may_tell()) {
      break;
    }
    error_code ignored;
    turn_.expires_after(more ? canopen::Duration::zero() : stream->pace());
    co_await turn_.async_wait(redirect_error(use_awaitable, ignored));
  }
  stream.reset();
  streams_ = false;
  send("{\"id\":" + id + ",\"end\":true,\"reason\":\"the gateway ends\"}");
}

awaitable<bool> Connection::tell_piece(Stream& stream) {
  if (waiting_.size() + leaving_ >= kMaxStreamWaiting) {
    co_return false;
  }
  const bool has_turn = co_await await_turn();
  if (!has_turn) {
    co_return false;
  }
  const canopen::TimePoint begin = canopen::Clock::now();
  std::string lines;
  const bool more = stream.take(lines);
  share_.note(begin, canopen::Clock::now());
  share_.leave(turn_);
  // However long: of a large plant the status alone is more than may wait of answers.
  piece_ = lines.size();
  send_lines(lines);
  co_return more;
}

awaitable<bool> Connection::await_turn() {
  // All clients of this socket are of this machine, and have their turns as they come.
  share_.enter(turn_, boost::asio::ip::address());
  while (may_tell()) {
    const canopen::TimePoint at = share_.when(turn_);
    if (at <= canopen::Clock::now()) {
      co_return true;
    }
    error_code ignored;
    turn_.expires_at(at);
    co_await turn_.async_wait(redirect_error(use_awaitable, ignored));
  }
  share_.leave(turn_);
  co_return false;
}

bool Connection::hung_up() {
  if (!socket_.is_open()) {
    return false;
  }
  pollfd looked{.fd = socket_.native_handle(), .events = 0, .revents = 0};
  return ::poll(&looked, 1, 0) > 0 && (looked.revents & (POLLHUP | POLLERR)) != 0;
}

}  // namespace gateway::control
