#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "canopen/clock.h"
#include "daemon/http/answer.h"
#include "daemon/http/event_source.h"
#include "daemon/http/hosts.h"
#include "daemon/http/live.h"
#include "daemon/http/loop_share.h"
#include "daemon/http/request.h"
#include "daemon/http/waiting_bytes.h"

namespace gateway::http {

/// Where the events of a stream come from.
struct LiveSource {
  std::function<Live::Place()> begin{};
  std::function<std::string(Live::Place&)> take{};  ///< See Live::take().
};

/// What all connections share; outlives them.
struct Shared {
  std::function<Answer(const Request&)> respond;
  Hosts hosts;
  LiveSource live{};
  std::function<bool(const boost::asio::ip::address&)> may_stream;  ///< One more reader of the stream.
  std::function<void(unsigned status)> answered;
  std::function<void(std::string_view address, std::string_view what)> warn;
  LoopShare share{};
  WaitingBytes waiting{};
};

/// One client: its requests are answered in order, one at a time.
class Connection {
 public:
  /// The rest of a request comes in this time.
  static constexpr canopen::Duration kHalfRequest = std::chrono::seconds(5);
  /// A client that asks nothing for so long is disconnected.
  static constexpr canopen::Duration kIdle = std::chrono::seconds(75);
  /// So is one that takes nothing of its answer for so long,
  static constexpr canopen::Duration kStalled = std::chrono::seconds(20);
  /// or, beyond that, less than so many bytes of it a second.
  static constexpr std::size_t kLeastRate = 10'000;
  /// After a last answer the client is to close; what it still sends is read away meanwhile.
  static constexpr canopen::Duration kLinger = std::chrono::seconds(2);

  Connection(boost::asio::ip::tcp::socket socket, const boost::asio::ip::address& from, Shared& shared);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Returns when the connection ended.
  boost::asio::awaitable<void> serve();
  /// Ends it. `why`: for the log.
  void close(const char* why);
  /// After serve(): why it ended; null where the client left, or was answered for the last time.
  [[nodiscard]] const char* ended() const noexcept { return ended_; }
  /// To be called each second: ends it where it takes too long.
  void look(canopen::TimePoint now);

  [[nodiscard]] const boost::asio::ip::address& from() const noexcept { return from_; }
  [[nodiscard]] const std::string& address() const noexcept { return address_; }
  /// It reads the stream.
  [[nodiscard]] bool streams() const noexcept { return streams_; }
  /// Since when nothing is to be done for it; nothing while it is being answered.
  [[nodiscard]] std::optional<canopen::TimePoint> idle_since() const noexcept;

 private:
  enum class State : std::uint8_t { reading, waiting, answering, streaming, lingering };

  /// A whole request is at the front of what was received, `head_` bytes long; false: the connection ended, or what
  /// came is none.
  boost::asio::awaitable<bool> receive();
  boost::asio::awaitable<bool> receive_more();
  /// Answers the request at the front. False: it was the last one.
  boost::asio::awaitable<bool> answer_first();
  [[nodiscard]] Answer begin_answer(const Request& request);
  /// Words what is still to be worded. False: the connection ended meanwhile.
  boost::asio::awaitable<bool> word_rest(Answer& answer);
  /// Waits until it may take time of the loop, and goes into this state. False: it is closed, and nothing is to be
  /// done.
  boost::asio::awaitable<bool> await_turn(State then);
  void end_turn(canopen::TimePoint begin);
  boost::asio::awaitable<void> stream();
  boost::asio::awaitable<void> stream_events(EventSource& source);
  /// The next events; empty: nothing changed. False: it is closed.
  boost::asio::awaitable<bool> next_events(Live::Place& place, std::string& events);
  /// Counts so many bytes as waiting for the client in place of those before. False: there is no room.
  [[nodiscard]] bool hold(std::size_t bytes);
  void release();
  [[nodiscard]] std::optional<Answer> object_to(const Request& request);
  boost::asio::awaitable<void> send(const Answer& answer, bool keep_alive, bool head_only);
  boost::asio::awaitable<void> send_file(const FileBody& file);
  boost::asio::awaitable<bool> send_bytes(std::string_view bytes);
  boost::asio::awaitable<void> refuse_and_end(Answer answer);
  boost::asio::awaitable<void> linger();
  void enter(State state);
  [[nodiscard]] bool is_sending() const noexcept { return state_ == State::answering || state_ == State::streaming; }

  boost::asio::ip::tcp::socket socket_;
  boost::asio::ip::address from_;
  std::string address_;
  Shared& shared_;
  canopen::Timer turn_;
  std::string received_;
  std::size_t head_ = 0;
  std::size_t looked_ = 0;
  std::size_t held_ = 0;  ///< Bytes of `shared_.waiting`.
  State state_ = State::reading;
  canopen::TimePoint since_;                    ///< Of the state, or of the newest progress in it.
  canopen::TimePoint until_ = canopen::kNever;  ///< The whole answer is to be taken.
  bool streams_ = false;
  const char* ended_ = nullptr;
};

}  // namespace gateway::http
