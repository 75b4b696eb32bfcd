#pragma once

#include <array>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/system/error_code.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridges/modbus/answers.h"
#include "bridges/modbus/arrivals.h"
#include "bridges/modbus/counts.h"
#include "bridges/modbus/exception.h"
#include "bridges/modbus/mbap.h"
#include "bridges/modbus/request.h"
#include "bridges/modbus/snapshot.h"
#include "bridges/modbus/units.h"
#include "bridges/net/tcp_options.h"
#include "bridges/process/command.h"
#include "bridges/process/writer.h"
#include "canopen/clock.h"

namespace modbus {

/// One connection: its requests are carried out strictly in order, one at a time, but for stops, which go before all
/// that waits; answers are always in order.
class Client {
 public:
  /// `units`, `answers` and `counts` outlive the client.
  Client(boost::asio::ip::tcp::socket socket, const boost::asio::ip::address& from, bool may_write, Units& units,
         Answers& answers, Counts& counts);

  /// Returns when the connection ended: by the client, by close(), or because it sent what is no Modbus.
  boost::asio::awaitable<void> serve();
  /// Ends the connection; serve() returns soon, a command that was begun is awaited. `why`: for the log.
  void close(const char* why);
  /// After serve(): why it ended; null where the client left.
  [[nodiscard]] const char* ended() const noexcept { return ended_; }
  /// What it sent first lay in the system's queue for so long that it may have given up.
  [[nodiscard]] bool came_late() const noexcept { return came_late_; }
  [[nodiscard]] bool sent_garbage() const noexcept { return sent_garbage_; }

  /// When it last asked for something or was answered; nothing while a command is carried out for it. One that does
  /// not read its answer was silent since it asked.
  [[nodiscard]] std::optional<canopen::TimePoint> idle_since() const noexcept;
  /// Since when the rest of a request is missing.
  [[nodiscard]] std::optional<canopen::TimePoint> half_since() const noexcept { return half_since_; }
  /// To be called each second.
  void look_after_slow_reader() { slow_reader_.look(socket_); }
  [[nodiscard]] const boost::asio::ip::address& from() const noexcept { return from_; }
  [[nodiscard]] const std::string& address() const noexcept { return writer_.address; }
  [[nodiscard]] bool may_write() const noexcept { return may_write_; }

 private:
  /// What is to be answered to the frame at hand.
  struct Answer {
    std::optional<Exception> exception;
    Request request;
    std::vector<std::uint8_t> pdu{};  ///< Where libmodbus has no words: the answer itself. Else empty.
  };

  /// A stop that was carried out before those in front of it.
  struct Overtaken {
    std::uint64_t position = 0;  ///< Its end.
    canopen::TimePoint came;
    std::optional<Exception> exception{};
  };

  /// False: the connection ended.
  boost::asio::awaitable<bool> receive();
  /// Notes what has come without waiting for it.
  void look();
  /// Answers reads at once; true: something remains to be carried out.
  [[nodiscard]] bool begin(std::span<const std::uint8_t> frame);
  /// Of the request that ends `used` bytes behind the beginning of what was received.
  boost::asio::awaitable<void> carry_out(std::uint8_t unit, std::size_t used);
  boost::asio::awaitable<void> write(std::uint8_t unit, std::size_t used);
  boost::asio::awaitable<void> stop_first(std::size_t used);
  /// The next stop among what has come behind `used`: its end; the stop itself is in ahead_.
  [[nodiscard]] std::optional<std::uint64_t> find_stop(std::size_t used);
  [[nodiscard]] process::Origin origin_of(std::uint64_t position);
  /// The whole answer to `frame`, in worded_.
  [[nodiscard]] std::span<const std::uint8_t> word_answer(std::span<const std::uint8_t> frame);
  void note_loss(const boost::system::error_code& failed) noexcept;
  void refuse(std::uint8_t function, Exception exception);

  boost::asio::ip::tcp::socket socket_;
  net::SlowReader slow_reader_;
  boost::asio::ip::address from_;
  process::Writer writer_;
  bool may_write_;
  Units& units_;
  Answers& answers_;
  Counts& counts_;

  std::array<std::uint8_t, kMaxFrame> received_{};
  std::array<std::uint8_t, kMaxFrame> worded_{};
  std::size_t filled_ = 0;
  std::uint64_t taken_ = 0;  ///< Bytes received since the connection began.
  Arrivals arrivals_;
  std::array<std::uint8_t, kMaxFrame> ahead_{};
  std::vector<Overtaken> overtaken_;  ///< In order; not yet answered.
  std::uint64_t looked_for_stops_ = 0;
  Answer answer_;
  Snapshot snapshot_;
  canopen::TimePoint active_;
  std::optional<canopen::TimePoint> half_since_;
  bool commanding_ = false;
  bool came_late_ = false;
  bool sent_garbage_ = false;
  const char* ended_ = nullptr;
};

}  // namespace modbus
