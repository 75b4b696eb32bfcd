#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/bus/link.h"
#include "canopen/bus/subscription.h"
#include "canopen/bus/ticket.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/event.h"
#include "canopen/object.h"
#include "canopen/sdo/exchange.h"
#include "canopen/sdo/line.h"
#include "canopen/sdo/sdo_settings.h"
#include "canopen/sdo/second_answer.h"
#include "canopen/sdo/stop_limit.h"
#include "canopen/sdo/transfer.h"
#include "canopen/sdo/unanswered.h"
#include "canopen/sdo/write_times.h"

namespace canopen {

class Bus;

/// The SDO client of one node (default channel, 0x600 and 0x580 + node id). One transfer at a time; who comes later
/// waits in order, stops before commands and these before the others. A read that is to be tried again lets them go
/// first, and one in segments or blocks is aborted for them and begun anew. Errors name node, object and abort code.
///
/// Late answers (Unanswered): an answer is taken only for the object that was asked for. Where an earlier request for
/// the same object was interrupted or went unanswered, its answer could pass for that of a new request; then another
/// object is read first, whose answer proves that the older requests are over. Where that proof does not come, a read
/// or setting uses up a try; a command is sent all the same, and its outcome is unknown whatever the drive answers. A
/// stop does not wait for that proof, see write_stop().
///
/// Another client's request to the node while one of ours is on its way: whose answer comes then nobody can tell. A
/// read or setting uses up a try, the outcome of a command is unknown. Such requests at other times change nothing.
///
/// Everything but commands and stops waits for the budget of the bus (SdoBudget).
///
/// The time of an answer counts from the departure of the request, so that a busy bus is no silent node. A request
/// belongs to its transfer: where that ends first it is withdrawn, and no try leaves after the next one. A `timeout`
/// with Error::not_sent says nothing about the node.
class SdoClient {
 public:
  using AbortHandler = std::function<void(std::uint32_t code)>;
  using RemarkHandler = std::function<void(std::string_view text)>;
  using SecondHandler = std::function<void(bool different)>;

  /// `bus` outlives the client.
  SdoClient(boost::asio::any_io_executor executor, Bus& bus, std::uint8_t node, SdoSettings settings);
  ~SdoClient() = default;
  SdoClient(const SdoClient&) = delete;
  SdoClient& operator=(const SdoClient&) = delete;

  /// Called for each abort the node sends, with 0 where it carried no code.
  void on_abort(AbortHandler handler) { abort_handler_ = std::move(handler); }
  /// Called where a person should know of something that no error tells.
  void on_remark(RemarkHandler handler) { remark_handler_ = std::move(handler); }

  /// Called where a request got a further answer, which no single server gives: see SecondAnswer.
  void on_second_answer(SecondHandler handler) { second_handler_ = std::move(handler); }

  /// Upload of a basic type, tried again after a timeout. More bytes than it has: the lower ones count; fewer:
  /// `protocol`. `due`: when it was to be done; of all reads that wait for the budget of the bus the earliest is next.
  boost::asio::awaitable<Result<Raw>> read(ObjectAddress object, DataType type, TimePoint due = Clock::now()) {
    return read(object, type, 1 + channel_.settings.retries, due);
  }
  /// Upload of an object whole, whatever it is: up to SdoTransfer::kMaxBytes, else `protocol`. `expected`: its bytes
  /// for a device that does not tell them; 0: not known. By block transfer where the settings say so and the node has
  /// not refused it since the last interruption. Where commands ended it kMostGivenUp times: `timeout`.
  boost::asio::awaitable<Result<std::vector<std::uint8_t>>> read_bytes(ObjectAddress object, std::size_t expected) {
    return run(SdoTransfer::upload(settings_of_whole(), object, expected), 1 + channel_.settings.retries, Clock::now());
  }
  /// read(), tried once: for finding out whether anybody is there.
  boost::asio::awaitable<Result<Raw>> probe(ObjectAddress object, DataType type) {
    return read(object, type, 1, Clock::now());
  }
  /// Download of a setting, tried again after a timeout. Never for what could move a motor.
  boost::asio::awaitable<Result<void>> write(ObjectAddress object, DataType type, Raw raw);
  /// Download of a command: sent once. Not begun by `deadline`, or when less time is left than the node needs for a
  /// write (WriteTimes, half of the time at most), or before a stop came: `timeout`, and it can never take effect.
  /// Begun and not confirmed by then, however long SdoSettings::timeout is, or a while after a stop came: `timeout`
  /// with outcome_unknown.
  boost::asio::awaitable<Result<void>> write_command(ObjectAddress object, DataType type, Raw raw, TimePoint deadline) {
    return send_command(download(object, type, raw), deadline);
  }
  /// The same with at least one byte of any meaning, by block transfer as read_bytes().
  boost::asio::awaitable<Result<void>> write_command(ObjectAddress object, std::span<const std::uint8_t> data,
                                                     TimePoint deadline) {
    return send_command(SdoTransfer::download(settings_of_whole(), object, data), deadline);
  }
  /// Download of a stop: before everything that waits but older stops, without proof, however little time is left. What
  /// is under way has 100 ms more for its answer: a read or setting is tried again behind the stop.
  ///
  /// An answer counts only if it cannot be that to an older request for the same object. Where one may be, it is taken
  /// for that, and the stop is sent again, up to `most_sent` times in all: as a server answers in order, one more
  /// answer than there were older requests proves that a stop was carried out behind them. The same once where another
  /// client asked the node meanwhile. Without such an answer by `deadline`, or by `limit`, which outlives the call:
  /// `timeout`, outcome_unknown, "sent, not confirmed".
  boost::asio::awaitable<Result<void>> write_stop(ObjectAddress object, DataType type, Raw raw, TimePoint deadline,
                                                  unsigned most_sent = kStopsSent,
                                                  const StopLimit& limit = kNoStopLimit);

  /// Upload for the sake of a stop: in its lane, tried once, until `deadline` or `limit`, which outlives the call.
  boost::asio::awaitable<Result<Raw>> read_for_stop(ObjectAddress object, DataType type, TimePoint deadline,
                                                    const StopLimit& limit = kNoStopLimit);
  /// A newer stop, to be sent by `deadline`, waits for the one of `limit`, be that under way or just to begin: it has
  /// 100 ms more for all its answers.
  void hurry_stop(StopLimit& limit, TimePoint deadline);

  /// Fails what is under way or waits with `offline`; what has not left is withdrawn. But a stop that has not left
  /// stays and goes; the outcome of one that has is unknown. The client can be used again at once.
  void interrupt();
  /// The same, and stops are called off, too. Sends nothing.
  void close();
  /// Fails the commands that have not left with `offline`. One that has left is awaited, and reads and stops go on.
  void withdraw_commands();

  /// Frames of the bus were lost: a request of somebody else may have been among them.
  void on_frames_lost() noexcept { second_.forget(); }

  /// The newest transfer since the last interruption got an answer, were it an abort.
  [[nodiscard]] bool answered() const noexcept { return answered_; }
  /// A download of `object` is under way, or went unanswered: a server that is slow may carry it out later yet.
  [[nodiscard]] bool may_still_act(ObjectAddress object) const noexcept;
  /// WriteTimes::longest() of its commands.
  [[nodiscard]] Duration write_time() const noexcept { return write_times_.longest(); }
  /// Nothing is under way or waits.
  [[nodiscard]] bool idle() const noexcept { return line_.empty(); }
  /// Returns once idle; to be awaited after interrupt() before the client goes.
  boost::asio::awaitable<void> until_idle() { return line_.until_empty(); }

  static constexpr unsigned kStopsSent = 8;
  static constexpr unsigned kMostGivenUp = 20;
  /// A node that was silent to block transfer in so many reads in a row does not know it; once a frame may be lost.
  static constexpr unsigned kSilentToBlock = 2;

 private:
  using Bytes = std::vector<std::uint8_t>;
  static constexpr std::size_t kLongestType = 8;
  static constexpr const char* kMayBeOlder = "the answer may be that to an earlier request";

  boost::asio::awaitable<Result<Raw>> read(ObjectAddress object, DataType type, unsigned tries, TimePoint due);
  [[nodiscard]] Result<Raw> raw_of(const Result<Bytes>& bytes, ObjectAddress object, DataType type) const;
  boost::asio::awaitable<Result<Bytes>> run(SdoTransfer transfer, unsigned tries, TimePoint due);
  boost::asio::awaitable<Result<void>> send_command(SdoTransfer transfer, TimePoint deadline);
  /// Whether no late answer for `object` can come any more.
  boost::asio::awaitable<bool> prove(ObjectAddress object, TimePoint until);
  boost::asio::awaitable<void> carry_out(SdoExchange& exchange);
  boost::asio::awaitable<void> carry_out_stop(SdoExchange& exchange, const StopLimit& limit);
  /// What is under way ends soon, for a stop that is to be sent by `deadline`.
  void make_way(TimePoint deadline);

  void on_frame(const Received& received);
  void on_foreign_request(const Received& received);
  void on_end(const SdoTransfer& transfer);
  void note_answer(std::span<const std::uint8_t> answer);
  void judge_unwanted(const Received& received) const;
  /// Somebody else asked so lately that an answer may be his.
  [[nodiscard]] bool others_ask(TimePoint now) const noexcept;
  [[nodiscard]] SdoTransfer upload(ObjectAddress object, std::size_t expected = kLongestType) const {
    return SdoTransfer::upload(channel_.settings, object, expected);
  }
  /// Block transfer no more where the node was found not to know it.
  [[nodiscard]] SdoSettings settings_of_whole() const;
  void on_block_unknown(std::string_view how);
  [[nodiscard]] SdoTransfer download(ObjectAddress object, DataType type, Raw raw) const;
  [[nodiscard]] Result<Bytes> result(const SdoExchange& exchange, ObjectAddress object) const;
  [[nodiscard]] Result<void> outcome(const SdoExchange& command, bool certain) const;
  /// Whether the answer that ended a stop can only be that to a stop; where not, it counts as one of the `older`.
  bool settles(const SdoExchange& stop, Unanswered::Count& older);
  [[nodiscard]] Error not_confirmed(const SdoExchange& stop) const;
  void send_abort(const SdoFrame& abort, TransmitClass transmit_class = TransmitClass::sdo);
  /// The abort of a transfer before a stop or command of that class leaves before it, or not at all any more.
  void send_abort_first(TransmitClass transmit_class);
  [[nodiscard]] Error addressed(Error error, ObjectAddress object) const;

  SdoExchange::Channel channel_;
  AbortHandler abort_handler_;
  RemarkHandler remark_handler_;
  SecondHandler second_handler_;

  SdoLine line_;
  SdoExchange* exchange_ = nullptr;  ///< Under way.
  const StopLimit* stop_ = nullptr;  ///< The limit of that, where it is a stop's.
  Ticket abort_;                     ///< The newest abort of ours,
  SdoFrame aborted_{};               ///< and what it says.
  std::uint64_t interruptions_ = 0;  ///< How often it was interrupted.
  Unanswered unanswered_;
  WriteTimes write_times_;
  bool answered_ = false;
  SecondAnswer second_;
  std::optional<TimePoint> foreign_at_;  ///< The newest request of somebody else.
  bool block_unknown_ = false;           ///< The node does not know block transfer.
  /// Reads in a row that it answered in segments, and not to block transfer before.
  unsigned silent_to_block_ = 0;

  Subscription subscription_;
  Subscription foreign_requests_;
};

}  // namespace canopen
