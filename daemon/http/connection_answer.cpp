// How a connection comes to an answer: in turns with all others, a piece of work each.

#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <memory>
#include <utility>
#include <variant>

#include "daemon/http/connection.h"
#include "daemon/http/wire.h"

namespace gateway::http {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::asio::ip::tcp;
using boost::system::error_code;

awaitable<bool> Connection::answer_first() {
  const bool has_turn = co_await await_turn(State::answering);
  if (!has_turn) {
    co_return false;
  }
  const canopen::TimePoint begin = canopen::Clock::now();
  auto read = read_head(std::string_view(received_).substr(0, head_));
  received_.erase(0, head_);
  if (auto* const refused = std::get_if<Refused>(&read)) {
    end_turn(begin);
    co_await refuse_and_end(std::move(refused->answer));
    co_return false;
  }
  const Request request = std::get<Request>(std::move(read));
  Answer answer = begin_answer(request);
  end_turn(begin);
  const bool worded = co_await word_rest(answer);
  if (!worded) {
    co_return false;
  }
  co_await send(answer, request.keep_alive, request.method == Method::head);
  if (streams_ && answer.events) {
    const std::unique_ptr<EventSource> source = answer.events();
    co_await stream_events(*source);
  } else if (streams_) {
    co_await stream();
  }
  const bool goes_on = request.keep_alive && !answer.stream && socket_.is_open();
  co_return goes_on;
}

Answer Connection::begin_answer(const Request& request) {
  if (std::optional<Answer> objection = object_to(request)) {
    return *std::move(objection);
  }
  Answer answer = shared_.respond(request);
  if (answer.stream && request.method == Method::get) {
    if (!shared_.may_stream(from_)) {
      return too_much("too many readers of the stream; close some, or ask for what you need");
    }
    streams_ = true;
  }
  return answer;
}

std::optional<Answer> Connection::object_to(const Request& request) {
  error_code failed;
  const tcp::endpoint own = socket_.local_endpoint(failed);
  if (!failed && shared_.hosts.knows(request.host, own.address())) {
    return std::nullopt;
  }
  const std::string host = std::string(beginning(request.host));
  shared_.warn(address_, "refused: asks for another host than this machine; name it in [http] hosts if it is one");
  return refusal(421, "this machine is not known as \"" + host +
                          "\"; ask by its address, or name it in [http] hosts of the gateway");
}

awaitable<bool> Connection::await_turn(State then) {
  enter(State::waiting);
  shared_.share.enter(turn_, from_);
  while (socket_.is_open()) {
    const canopen::TimePoint at = shared_.share.when(turn_);
    if (at <= canopen::Clock::now()) {
      enter(then);
      co_return true;
    }
    error_code ignored;
    turn_.expires_at(at);
    co_await turn_.async_wait(redirect_error(use_awaitable, ignored));
  }
  shared_.share.leave(turn_);
  co_return false;
}

void Connection::end_turn(canopen::TimePoint begin) {
  shared_.share.note(begin, canopen::Clock::now());
  shared_.share.leave(turn_);
}

awaitable<bool> Connection::word_rest(Answer& answer) {
  bool has_room = hold(answer.body.size());
  while (has_room && answer.rest) {
    // The bus first, even where the piece before took no time that can be told.
    co_await boost::asio::post(socket_.get_executor(), use_awaitable);
    const bool has_turn = co_await await_turn(State::answering);
    if (!has_turn) {
      co_return false;
    }
    const canopen::TimePoint begin = canopen::Clock::now();
    const Progress progress = answer.rest(answer.body);
    end_turn(begin);
    if (!progress.goes_on) {
      answer.rest = nullptr;
    }
    has_room = hold(answer.body.size() + progress.kept);
  }
  if (!has_room) {
    answer = too_much("too many large answers wait for clients that do not take them; ask again");
  }
  co_return true;
}

bool Connection::hold(std::size_t bytes) {
  const bool has_room = shared_.waiting.has_room(from_, held_, bytes);
  release();
  held_ = has_room ? bytes : 0;
  shared_.waiting.add(from_, held_);
  return has_room;
}

void Connection::release() {
  shared_.waiting.remove(from_, std::exchange(held_, 0));
}

}  // namespace gateway::http
