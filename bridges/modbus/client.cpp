#include "bridges/modbus/client.h"

#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/system/error_code.hpp>
#include <chrono>
#include <utility>
#include <variant>

namespace modbus {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::asio::ip::tcp;

namespace {

// Added to the function that an exception answers. Who asks for one that has it already is answered with the same code;
// libmodbus would add it again, and 0x90 would read like a write that was carried out.
constexpr std::uint8_t kExceptionBit = 0x80;

// A first request waits where the gateway was not there to take the connection: started anew behind a socket of the
// service manager, stopped, or without descriptors.
constexpr canopen::Duration kMayHaveGivenUp = std::chrono::seconds(1);

// How far a stop is looked for behind a write that waits: about 300 writes of one register.
constexpr std::size_t kLookAhead = 4096;

}  // namespace

Client::Client(tcp::socket socket, const boost::asio::ip::address& from, bool may_write, Units& units, Answers& answers,
               Counts& counts)
    : socket_(std::move(socket)),
      from_(from),
      writer_{.way = process::Writer::Way::modbus, .address = from.to_string()},
      may_write_(may_write),
      units_(units),
      answers_(answers),
      counts_(counts),
      arrivals_(canopen::Clock::now()),
      active_(canopen::Clock::now()) {}

void Client::close(const char* why) {
  if (ended_ == nullptr) {
    ended_ = why;
  }
  boost::system::error_code ignored;  // It is gone either way.
  socket_.shutdown(tcp::socket::shutdown_both, ignored);
  socket_.close(ignored);
}

std::optional<canopen::TimePoint> Client::idle_since() const noexcept {
  // What takes long for a client that may not write is no command, but a read of an object.
  return commanding_ && may_write_ ? std::nullopt : std::optional(active_);
}

awaitable<void> Client::serve() {
  boost::system::error_code failed;
  while (co_await receive()) {
    const std::span<const std::uint8_t> bytes(received_.data(), filled_);
    std::size_t used = 0;
    FoundFrame found = find_frame(bytes);
    for (; found.framing == Framing::complete; found = find_frame(bytes.subspan(used))) {
      const std::span<const std::uint8_t> frame = bytes.subspan(used, found.size);
      used += found.size;
      active_ = canopen::Clock::now();
      half_since_.reset();
      if (begin(frame)) {
        co_await carry_out(unit_of(frame), used);
        // What is there by now was sent before it is answered.
        look();
      }
      const std::uint64_t position = taken_ - filled_ + used;
      arrivals_.forget(position);
      std::erase_if(overtaken_, [position](const Overtaken& stop) { return stop.position <= position; });
      const std::span<const std::uint8_t> answer = word_answer(frame);
      if (answer.empty()) {
        ended_ = "disconnected: there are no words for its answer";
        co_return;
      }
      const auto worded = boost::asio::buffer(answer.data(), answer.size());
      slow_reader_.on_answer();
      co_await boost::asio::async_write(socket_, worded, redirect_error(use_awaitable, failed));
      if (failed) {
        note_loss(failed);
        co_return;
      }
    }
    if (found.framing == Framing::broken) {
      sent_garbage_ = true;
      co_return;
    }
    std::copy(received_.begin() + static_cast<std::ptrdiff_t>(used),
              received_.begin() + static_cast<std::ptrdiff_t>(filled_), received_.begin());
    filled_ -= used;
    if (filled_ != 0 && !half_since_) {
      half_since_ = canopen::Clock::now();
    }
  }
}

awaitable<bool> Client::receive() {
  look();
  boost::system::error_code failed;
  const auto room = boost::asio::buffer(received_.data() + filled_, received_.size() - filled_);
  const std::size_t count = co_await socket_.async_read_some(room, redirect_error(use_awaitable, failed));
  if (failed) {
    note_loss(failed);
    co_return false;
  }
  came_late_ = taken_ == 0 && net::silence(socket_) > kMayHaveGivenUp;
  if (came_late_) {
    co_return false;
  }
  filled_ += count;
  taken_ += count;
  arrivals_.on_awaited(taken_, canopen::Clock::now());
  co_return true;
}

void Client::look() {
  boost::system::error_code failed;
  const std::size_t waiting = socket_.available(failed);
  arrivals_.on_look(taken_ + (failed ? 0 : waiting), canopen::Clock::now());
}

void Client::note_loss(const boost::system::error_code& failed) noexcept {
  if (ended_ == nullptr && failed == boost::asio::error::timed_out) {
    ended_ = "lost: nothing comes back from it any more";
  }
}

bool Client::begin(std::span<const std::uint8_t> frame) {
  const std::uint8_t unit = unit_of(frame);
  const std::uint8_t function = pdu_of(frame)[0];
  answer_.pdu.clear();
  if (!units_.has(unit)) {
    refuse(function, Exception::unknown_unit);
    return false;
  }
  const std::variant<Request, Exception> parsed = parse_request(pdu_of(frame));
  if (const auto* const refused = std::get_if<Exception>(&parsed)) {
    refuse(function, *refused);
    return false;
  }
  answer_.request = std::get<Request>(parsed);
  answer_.exception.reset();
  if (may_write_) {
    units_.sign_of_life(unit, answer_.request, writer_);
  }
  if (answer_.request.is_encapsulated()) {
    return true;
  }
  if (answer_.request.writes() && !may_write_) {
    units_.note_refused(unit, answer_.request, {.writer = writer_},
                        {.kind = canopen::ErrorKind::forbidden, .detail = "[modbus] write_from does not name it"});
    answer_.exception = Exception::illegal_function;
    return false;
  }
  // Of function 23 too, before anything is sent to the drive: a write whose read part must fail is not begun. But for a
  // stop, which nothing keeps back.
  if (answer_.request.reads()) {
    answer_.exception = units_.read(unit, answer_.request, canopen::Clock::now(), snapshot_);
  }
  if (!answer_.request.writes() || !answer_.exception || units_.is_stop(unit, answer_.request)) {
    return answer_.request.writes();
  }
  units_.note_refused(unit, answer_.request, {.writer = writer_},
                      {.kind = canopen::ErrorKind::incomplete,
                       .detail = "what function 23 was to read cannot be read, so nothing was written"});
  return false;
}

awaitable<void> Client::carry_out(std::uint8_t unit, std::size_t used) {
  const std::uint64_t position = taken_ - filled_ + used;
  commanding_ = true;
  if (!overtaken_.empty() && overtaken_.front().position == position) {
    answer_.exception = overtaken_.front().exception;
  } else {
    co_await write(unit, used);
  }
  commanding_ = false;
  active_ = canopen::Clock::now();
  if (!units_.has(unit)) {
    answer_.exception = answer_.exception.value_or(Exception::no_response);  // it went while a stop was carried out
  }
  if (answer_.request.reads() && !answer_.exception) {
    answer_.exception = units_.read(unit, answer_.request, canopen::Clock::now(), snapshot_);
    if (answer_.exception) {
      units_.note_unread(unit, answer_.request, writer_, *answer_.exception);
    }
  }
}

awaitable<void> Client::write(std::uint8_t unit, std::size_t used) {
  const bool is_stop = answer_.request.writes() && units_.is_stop(unit, answer_.request);
  if (may_write_ && !is_stop) {
    co_await stop_first(used);
  }
  process::Origin origin = origin_of(taken_ - filled_ + used);
  if (!units_.has(unit) || (!is_stop && origin.received <= units_.there_since(unit, answer_.request))) {
    answer_.exception = Exception::no_response;  // the plant changed since it came
    co_return;
  }
  if (!answer_.request.is_encapsulated()) {
    answer_.exception = co_await units_.write(unit, answer_.request, std::move(origin));
    co_return;
  }
  EncapsulatedAnswer answer = co_await units_.encapsulated(unit, answer_.request, std::move(origin), may_write_);
  if (auto* const pdu = std::get_if<std::vector<std::uint8_t>>(&answer)) {
    answer_.pdu = std::move(*pdu);
  } else {
    answer_.exception = std::get<Exception>(answer);
  }
}

process::Origin Client::origin_of(std::uint64_t position) {
  Arrivals::Between came = arrivals_.of(position);
  if (!overtaken_.empty()) {
    // A stop behind it has gone first, perhaps one of the same moment.
    came.earliest = std::min(came.earliest, overtaken_.front().came - canopen::Duration(1));
  }
  return {.writer = writer_, .received = came.earliest, .received_until = came.latest};
}

awaitable<void> Client::stop_first(std::size_t used) {
  look();
  while (const std::optional<std::uint64_t> position = find_stop(used)) {
    const Arrivals::Between came = arrivals_.of(*position);
    process::Origin origin{.writer = writer_, .received = came.earliest, .received_until = came.latest};
    const std::uint8_t unit = unit_of(ahead_);
    const Request stop = std::get<Request>(parse_request(pdu_of(std::span(ahead_).first(find_frame(ahead_).size))));
    const std::optional<Exception> exception = co_await units_.write(unit, stop, std::move(origin));
    overtaken_.push_back({.position = *position, .came = came.latest, .exception = exception});
    look();
  }
}

std::optional<std::uint64_t> Client::find_stop(std::size_t used) {
  std::array<std::uint8_t, kLookAhead> bytes{};
  const std::size_t held = filled_ - used;
  std::copy_n(received_.begin() + static_cast<std::ptrdiff_t>(used), held, bytes.begin());
  const ssize_t peeked =
      ::recv(socket_.native_handle(), bytes.data() + held, bytes.size() - held, MSG_PEEK | MSG_DONTWAIT);
  const std::span<const std::uint8_t> there(bytes.data(),
                                            held + static_cast<std::size_t>(std::max<ssize_t>(peeked, 0)));
  std::uint64_t position = taken_ - held;
  std::size_t begin = 0;
  for (FoundFrame found = find_frame(there); found.framing == Framing::complete;
       found = find_frame(there.subspan(begin))) {
    const std::span<const std::uint8_t> frame = there.subspan(begin, found.size);
    begin += found.size;
    position += found.size;
    if (position <= looked_for_stops_) {
      continue;
    }
    looked_for_stops_ = position;
    const std::variant<Request, Exception> parsed = parse_request(pdu_of(frame));
    const auto* const request = std::get_if<Request>(&parsed);
    if (request != nullptr && request->writes() && units_.has(unit_of(frame)) &&
        units_.is_stop(unit_of(frame), *request)) {
      std::ranges::copy(frame, ahead_.begin());
      return position;
    }
  }
  return std::nullopt;
}

void Client::refuse(std::uint8_t function, Exception exception) {
  answer_.exception = exception;
  if (function >= kExceptionBit) {
    answer_.pdu = {function, static_cast<std::uint8_t>(exception)};
  }
}

std::span<const std::uint8_t> Client::word_answer(std::span<const std::uint8_t> frame) {
  ++counts_.requests;
  if (answer_.exception) {
    counts_.add(*answer_.exception);
  }
  if (!answer_.pdu.empty()) {
    return frame_answer(frame, answer_.pdu, worded_);
  }
  return answer_.exception ? answers_.refuse(frame, *answer_.exception, worded_)
                           : answers_.answer(frame, answer_.request, snapshot_, worded_);
}

}  // namespace modbus
