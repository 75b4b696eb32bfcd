#include "canopen/sdo/client.h"

#include <algorithm>
#include <array>
#include <utility>

#include "canopen/bus/bus.h"

namespace canopen {
namespace {

constexpr std::uint32_t kAnswerBase = 0x580;  // CiA 301 table 75, default SDO.
constexpr std::uint32_t kAbortTimedOut = 0x05040000;
constexpr ObjectAddress kDeviceType{0x1000, 0};  // Every node has it; where not, the abort is an answer, too.

}  // namespace

/// The exchange that has the channel, where the frame handler finds it.
class SdoClient::OnChannel {
 public:
  OnChannel(SdoClient& client, SdoExchange& exchange) : client_(client) { client_.exchange_ = &exchange; }
  ~OnChannel() { client_.exchange_ = nullptr; }
  OnChannel(const OnChannel&) = delete;
  OnChannel& operator=(const OnChannel&) = delete;

 private:
  SdoClient& client_;
};

SdoClient::SdoClient(boost::asio::any_io_executor executor, Bus& bus, std::uint8_t node, SdoSettings settings)
    : executor_(std::move(executor)),
      bus_(bus),
      node_(node),
      settings_(settings),
      line_(executor_, bus.sdo_budget()),
      subscription_(bus.subscribe(kAnswerBase + node, [this](const Received& received) { on_frame(received); })) {}

// Named locals wherever a coroutine takes a value: g++ 12 mishandles temporaries in the operand of co_await.

boost::asio::awaitable<Result<SdoClient::Bytes>> SdoClient::upload(ObjectAddress object, std::size_t expected) {
  SdoTransfer transfer = SdoTransfer::upload(settings_, object, expected);
  co_return co_await run(std::move(transfer), 1 + settings_.retries, Clock::now());
}

boost::asio::awaitable<Result<Raw>> SdoClient::read(ObjectAddress object, DataType type, unsigned tries,
                                                    TimePoint due) {
  SdoTransfer transfer = SdoTransfer::upload(settings_, object, byte_length(type));
  const Result<Bytes> bytes = co_await run(std::move(transfer), tries, due);
  if (bytes.has_error()) {
    co_return bytes.error();
  }
  if (const std::optional<Raw> raw = decode_raw(type, bytes.value())) {
    co_return *raw;
  }
  co_return error(ErrorKind::protocol, object,
                  "answer has " + std::to_string(bytes.value().size()) + " bytes, type " + std::string(name_of(type)) +
                      " needs " + std::to_string(byte_length(type)));
}

boost::asio::awaitable<Result<void>> SdoClient::write(ObjectAddress object, DataType type, Raw raw) {
  SdoTransfer transfer = download(object, type, raw);
  const Result<Bytes> done = co_await run(std::move(transfer), 1 + settings_.retries, Clock::now());
  co_return done.has_error() ? Result<void>(done.error()) : Result<void>();
}

boost::asio::awaitable<Result<void>> SdoClient::write_command(ObjectAddress object, DataType type, Raw raw,
                                                              TimePoint deadline, StillStands still_stands) {
  SdoTransfer transfer = download(object, type, raw);
  co_return co_await run_command(std::move(transfer), deadline, std::move(still_stands));
}

boost::asio::awaitable<Result<SdoClient::Bytes>> SdoClient::run(SdoTransfer transfer, unsigned tries, TimePoint due) {
  SdoLine::Place place(line_, SdoLine::Kind::transfer, due);
  SdoLine::Verdict verdict = co_await place.wait_until(TimePoint::max());
  if (verdict != SdoLine::Verdict::mine) {
    co_return not_granted(verdict, transfer.object());
  }
  const Result<bool> settled = co_await settle_late(transfer.object(), TimePoint::max());
  if (settled.has_error()) {
    co_return settled.error();
  }
  for (; place.verdict() == SdoLine::Verdict::mine; --tries) {
    SdoTransfer fresh = transfer;
    Result<Bytes> result = co_await try_once(std::move(fresh), TimePoint::max());
    if (tries <= 1 || result.has_value() || result.error().kind != ErrorKind::timeout) {
      co_return result;
    }
    bus_.sdo_budget().charge();
    // All tries together may take longer than a command has, and that command may be a stop.
    if (place.give_way()) {
      static_cast<void>(co_await place.wait_until(TimePoint::max()));
    }
  }
  co_return not_granted(place.verdict(), transfer.object());
}

boost::asio::awaitable<Result<SdoClient::Bytes>> SdoClient::try_once(SdoTransfer transfer, TimePoint deadline) {
  const bool late_possible = late_.expected(transfer.object());
  SdoExchange exchange(channel(), std::move(transfer), TransmitClass::sdo, deadline, late_possible);
  co_await run(exchange);
  if (exchange.error()) {
    co_return *exchange.error();
  }
  co_return exchange.transfer().data();
}

boost::asio::awaitable<Result<void>> SdoClient::run_command(SdoTransfer transfer, TimePoint deadline,
                                                            StillStands still_stands) {
  const ObjectAddress object = transfer.object();
  SdoLine::Place place(line_, SdoLine::Kind::command, Clock::now());
  if (exchange_ != nullptr && !exchange_->is_command()) {
    exchange_->withdraw();  // A read that has not even left must not hold back what may be a stop.
  }
  const SdoLine::Verdict verdict = co_await place.wait_until(deadline);
  if (verdict != SdoLine::Verdict::mine) {
    co_return not_granted(verdict, object);
  }
  // Half of its time at most: it may be a stop, and is sent to a silent drive, too.
  const TimePoint now = Clock::now();
  const Result<bool> settled = co_await settle_late(object, now + (deadline - now) / 2);
  if (place.verdict() != SdoLine::Verdict::mine) {
    co_return not_granted(place.verdict(), object);
  }
  if (settled.has_error() && settled.error().kind != ErrorKind::timeout) {
    co_return settled.error();
  }
  const bool conclusive = settled.has_value() && settled.value();
  if (still_stands && !still_stands()) {
    co_return error(ErrorKind::incomplete, object, "not begun: what it was made from has changed");
  }
  co_return co_await exchange_command(std::move(transfer), deadline, conclusive, place);
}

boost::asio::awaitable<Result<void>> SdoClient::exchange_command(SdoTransfer transfer, TimePoint deadline,
                                                                 bool conclusive, const SdoLine::Place& place) {
  const ObjectAddress object = transfer.object();
  const bool late_possible = late_.expected(object);
  abort_.reset();  // Of a transfer before it: behind the command it could end that one.
  SdoExchange exchange(channel(), std::move(transfer), TransmitClass::command, deadline, late_possible);
  co_await run(exchange);
  const std::optional<Error>& error_met = exchange.error();
  if (exchange.not_begun()) {
    co_return place.verdict() == SdoLine::Verdict::mine ? *error_met : not_granted(place.verdict(), object);
  }
  if (!conclusive && (!error_met || error_met->kind == ErrorKind::refused)) {
    // That was perhaps the answer to the earlier one, so ours is still to come.
    late_.note_unanswered(object, settings_.timeout);
  }
  if (error_met && (conclusive || error_met->kind != ErrorKind::refused)) {
    Error failure = *error_met;
    failure.outcome_unknown = failure.kind != ErrorKind::refused;
    co_return failure;
  }
  if (!conclusive) {
    Error unclear = error(ErrorKind::timeout, object, "the answer may be that to an earlier request");
    unclear.outcome_unknown = true;
    co_return unclear;
  }
  co_return Result<void>();
}

boost::asio::awaitable<Result<bool>> SdoClient::settle_late(ObjectAddress object, TimePoint due) {
  if (!late_.expected(object)) {
    co_return true;
  }
  const ObjectAddress other = late_.readable().value_or(kDeviceType);
  if (late_.expected(other)) {
    co_return false;
  }
  bus_.sdo_budget().charge();
  SdoTransfer transfer = SdoTransfer::upload(settings_, other, 0);
  const Result<Bytes> answer = co_await try_once(std::move(transfer), due);
  if (answer.has_value() || answer.error().kind == ErrorKind::refused || answer.error().kind == ErrorKind::protocol) {
    co_return true;
  }
  Error failure = answer.error();
  failure.object = object;
  if (failure.kind == ErrorKind::timeout) {
    failure.detail = "not begun: an earlier request for it went unanswered, and now the drive is silent";
  }
  co_return failure;
}

boost::asio::awaitable<void> SdoClient::run(SdoExchange& exchange) {
  const OnChannel on_channel(*this, exchange);
  co_await exchange.run();
  if (exchange.silent()) {
    const ObjectAddress object = exchange.transfer().object();
    answered_ = false;
    late_.note_unanswered(object, settings_.timeout);
    if (exchange.transfer().in_segments()) {
      send_abort(abort_request(object, kAbortTimedOut));
    }
  }
}

void SdoClient::on_frame(const Received& received) {
  if (exchange_ == nullptr || exchange_->over()) {
    return;
  }
  switch (exchange_->on_answer(received.frame.bytes())) {
    case SdoTransfer::Step::ignored:
      return;
    case SdoTransfer::Step::more:
      answered_ = true;
      return;
    case SdoTransfer::Step::completed:
    case SdoTransfer::Step::failed:
      answered_ = true;
      on_end(exchange_->transfer());
      return;
  }
}

void SdoClient::on_end(const SdoTransfer& transfer) {
  late_.note_answered(transfer.object(), transfer.completed_upload());
  if (transfer.abort()) {
    send_abort(*transfer.abort());
  }
  if (transfer.error().kind == ErrorKind::refused && abort_handler_) {
    abort_handler_(transfer.error().abort);
  }
  if (!transfer.remark().empty() && remark_handler_) {
    remark_handler_(to_string(transfer.object()) + ": " + transfer.remark());
  }
}

void SdoClient::withdraw_commands() {
  line_.withdraw_commands();
  if (exchange_ != nullptr && exchange_->is_command()) {
    exchange_->withdraw();
  }
}

void SdoClient::interrupt() {
  line_.interrupt();
  answered_ = false;
  abort_.reset();
  if (exchange_ != nullptr && !exchange_->over()) {
    exchange_->interrupt(interruption(exchange_->transfer().object()));
  }
}

SdoTransfer SdoClient::download(ObjectAddress object, DataType type, Raw raw) const {
  std::array<std::uint8_t, 8> data{};
  const unsigned length = encode_raw(type, raw, data);
  return SdoTransfer::download(settings_, object, std::span<const std::uint8_t>(data).first(length));
}

void SdoClient::send_abort(const SdoFrame& abort) {
  abort_ = bus_.send(TransmitClass::sdo, sdo_request_frame(node_, abort), Clock::now() + TransmitQueue::kLifeTime);
}

SdoExchange::Channel SdoClient::channel() const noexcept {
  return {executor_, bus_, node_, settings_};
}

Error SdoClient::error(ErrorKind kind, ObjectAddress object, std::string detail) const {
  return {.kind = kind, .node = node_, .object = object, .detail = std::move(detail)};
}

Error SdoClient::interruption(ObjectAddress object) const {
  return error(ErrorKind::offline, object, "the drive was lost, rebooted or removed");
}

Error SdoClient::not_granted(SdoLine::Verdict verdict, ObjectAddress object) const {
  switch (verdict) {
    case SdoLine::Verdict::late:
      return error(ErrorKind::timeout, object, "not begun: other SDO transfers held the channel");
    case SdoLine::Verdict::withdrawn:
      return error(ErrorKind::offline, object, "withdrawn: the drive left operational, or is about to");
    default:
      return interruption(object);
  }
}

}  // namespace canopen
