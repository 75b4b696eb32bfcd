#include "daemon/http/connection.h"

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <utility>

#include "daemon/http/wire.h"

namespace gateway::http {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::size_t kPiece = 16UL * 1024;      // that a turn of the loop copies to the system
constexpr std::size_t kMostRest = 256UL * 1024;  // of what is read away

}  // namespace

Connection::Connection(tcp::socket socket, const boost::asio::ip::address& from, Shared& shared)
    : socket_(std::move(socket)),
      from_(from),
      address_(from.to_string()),
      shared_(shared),
      turn_(socket_.get_executor()),
      since_(canopen::Clock::now()) {}

Connection::~Connection() {
  release();
}

void Connection::close(const char* why) {
  if (ended_ == nullptr) {
    ended_ = why;
  }
  error_code ignored;  // It is gone either way.
  socket_.shutdown(tcp::socket::shutdown_both, ignored);
  socket_.close(ignored);
  turn_.cancel();
}

std::optional<canopen::TimePoint> Connection::idle_since() const noexcept {
  return is_sending() || state_ == State::waiting ? std::nullopt : std::optional(since_);
}

void Connection::enter(State state) {
  state_ = state;
  since_ = canopen::Clock::now();
}

void Connection::look(canopen::TimePoint now) {
  const canopen::Duration waited = now - since_;
  if (is_sending() && waited >= kStalled) {
    close("disconnected: it takes nothing of its answer");
  } else if (is_sending() && now >= until_) {
    close("disconnected: it takes its answer too slowly");
  } else if (state_ == State::lingering && waited >= kLinger) {
    close("disconnected: it had its last answer");
  } else if (state_ == State::reading && !received_.empty() && waited >= kHalfRequest) {
    close("disconnected: the rest of its request did not come");
  } else if (state_ == State::reading && waited >= kIdle) {
    close("disconnected: idle");
  }
}

awaitable<void> Connection::serve() {
  bool goes_on = co_await receive();
  while (goes_on) {
    goes_on = co_await answer_first();
    if (!goes_on) {
      break;
    }
    // Whoever sends many at once does not keep the bus waiting.
    co_await boost::asio::post(socket_.get_executor(), use_awaitable);
    goes_on = co_await receive();
  }
  if (socket_.is_open() && state_ == State::answering) {
    co_await linger();
  }
}

awaitable<bool> Connection::receive() {
  enter(State::reading);
  looked_ = 0;
  for (;;) {
    if (const auto end = find_head_end(received_, looked_)) {
      head_ = *end;
      co_return true;
    }
    looked_ = received_.size();
    if (is_foreign(received_)) {
      co_await refuse_and_end(refusal(400, "this is no HTTP/1.1 request; TLS is not served here: write http://"));
      co_return false;
    }
    if (received_.size() >= kMaxHead) {
      co_await refuse_and_end(
          refusal(431, "the request is longer than " + std::to_string(kMaxHead) + " bytes; ask with fewer headers"));
      co_return false;
    }
    const bool came = co_await receive_more();
    if (!came) {
      co_return false;
    }
  }
}

awaitable<bool> Connection::receive_more() {
  std::array<char, 4096> piece{};
  error_code failed;
  const auto room = boost::asio::buffer(piece.data(), std::min(piece.size(), kMaxHead - received_.size()));
  const std::size_t count = co_await socket_.async_read_some(room, redirect_error(use_awaitable, failed));
  if (failed) {
    co_return false;
  }
  if (received_.empty()) {
    since_ = canopen::Clock::now();  // The deadline of a request counts from its first byte.
  }
  received_.append(piece.data(), count);
  co_return true;
}

awaitable<void> Connection::send(const Answer& answer, bool keep_alive, bool head_only) {
  shared_.answered(answer.status);
  enter(State::answering);
  until_ = since_ + kStalled + std::chrono::seconds(answer.size() / kLeastRate);
  const std::string head = word_head(answer, keep_alive);
  bool sent = co_await send_bytes(head);
  if (sent && !head_only && answer.file) {
    co_await send_file(*answer.file);
  } else if (sent && !head_only) {
    sent = co_await send_bytes(answer.text());
  }
  until_ = canopen::kNever;
  release();
}

awaitable<bool> Connection::send_bytes(std::string_view bytes) {
  while (!bytes.empty()) {
    error_code failed;
    const auto piece = boost::asio::buffer(bytes.data(), std::min(bytes.size(), kPiece));
    const std::size_t count = co_await socket_.async_write_some(piece, redirect_error(use_awaitable, failed));
    if (failed) {
      error_code ignored;
      socket_.close(ignored);
      co_return false;
    }
    since_ = canopen::Clock::now();
    bytes.remove_prefix(count);
  }
  co_return true;
}

// What was announced and cannot be read, or has another length by now, ends with the connection: the client sees that
// something is missing.
awaitable<void> Connection::send_file(const FileBody& file) {
  std::uint64_t offset = 0;
  while (offset < file.size && socket_.is_open()) {
    std::optional<std::string> piece = co_await file.read(offset);
    if (!piece || piece->empty()) {
      close("disconnected: the file that it reads is gone");
      break;
    }
    piece->resize(std::min<std::uint64_t>(piece->size(), file.size - offset));
    held_ = piece->size();  // never refused: a piece is small
    shared_.waiting.add(from_, held_);
    offset += piece->size();
    co_await send_bytes(*piece);
    release();
  }
}

awaitable<bool> Connection::next_events(Live::Place& place, std::string& events) {
  const bool has_turn = co_await await_turn(State::streaming);
  if (has_turn) {
    const canopen::TimePoint begin = canopen::Clock::now();
    events = shared_.live.take(place);
    end_turn(begin);
  }
  co_return has_turn;
}

// A reader that is slow is told of the newest state when it has taken the one before, and how often it was not told
// meanwhile. So no more than one piece waits for it.
awaitable<void> Connection::stream() {
  enter(State::streaming);
  Live::Place place = shared_.live.begin();
  canopen::TimePoint heard = since_;
  std::string late;
  while (socket_.is_open()) {
    std::string events;
    const bool has_turn = co_await next_events(place, events);
    if (!has_turn) {
      break;
    }
    const canopen::TimePoint begin = canopen::Clock::now();
    events.insert(0, std::exchange(late, {}));
    since_ = begin;
    if (events.empty() && begin - heard >= Live::kSilence) {
      events = ":\n\n";  // a comment: the reader knows that the line stands
    }
    held_ = events.size();  // never refused: a piece is small
    shared_.waiting.add(from_, held_);
    co_await send_bytes(events);
    release();
    const canopen::TimePoint end = canopen::Clock::now();
    heard = events.empty() ? heard : end;
    if (const auto missed = (end - begin) / Live::kPace; missed > 0) {
      Live::append_event(late, "skipped", "{\"times\":" + std::to_string(missed) + "}");
    }
    error_code ignored;
    turn_.expires_at(place.more ? end : begin + Live::kPace);
    co_await turn_.async_wait(redirect_error(use_awaitable, ignored));
  }
}

awaitable<void> Connection::refuse_and_end(Answer answer) {
  enter(State::answering);
  co_await send(answer, false, false);
}

// Closed with bytes unread, the system would reset the connection, and the client might lose the answer.
awaitable<void> Connection::linger() {
  enter(State::lingering);
  error_code failed;
  socket_.shutdown(tcp::socket::shutdown_send, failed);
  std::array<char, 4096> rest{};
  for (std::size_t read = 0; !failed && read < kMostRest;) {
    read += co_await socket_.async_read_some(boost::asio::buffer(rest), redirect_error(use_awaitable, failed));
  }
}

}  // namespace gateway::http
