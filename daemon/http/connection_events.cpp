// A stream that is one reader's own.

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>

#include "daemon/http/connection.h"

namespace gateway::http {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;

// No more than one piece waits for a slow reader. What he loses meanwhile, his source counts.
awaitable<void> Connection::stream_events(EventSource& source) {
  enter(State::streaming);
  canopen::TimePoint heard = since_;
  while (socket_.is_open()) {
    const bool has_turn = co_await await_turn(State::streaming);
    if (!has_turn) {
      break;
    }
    const canopen::TimePoint begin = canopen::Clock::now();
    std::string events;
    const bool more = source.take(events);
    end_turn(begin);
    if (events.empty() && begin - heard >= Live::kSilence) {
      events = ":\n\n";  // a comment: the reader knows that the line stands
    }
    heard = events.empty() ? heard : begin;
    held_ = events.size();  // never refused: a piece is small
    shared_.waiting.add(from_, held_);
    co_await send_bytes(events);
    release();
    boost::system::error_code ignored;
    turn_.expires_at(more ? begin : begin + source.pace());
    co_await turn_.async_wait(redirect_error(use_awaitable, ignored));
  }
}

}  // namespace gateway::http
