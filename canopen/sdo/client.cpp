#include "canopen/sdo/client.h"

#include <algorithm>
#include <array>
#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/sdo/abort_codes.h"

namespace canopen {
namespace {

constexpr const char* kInterrupted = "the drive was lost, rebooted or removed";

}  // namespace

SdoClient::SdoClient(boost::asio::any_io_executor executor, Bus& bus, std::uint8_t node, SdoSettings settings)
    : channel_{std::move(executor), bus, node, settings},
      line_(channel_.executor, bus.sdo_budget()),
      unanswered_(settings.timeout),
      subscription_(bus.subscribe(kSdoAnswerBase + node, [this](const Received& received) { on_frame(received); })),
      // Echoes of our own are never dispatched.
      foreign_requests_(
          bus.subscribe(kSdoRequestBase + node, [this](const Received& received) { on_foreign_request(received); })) {}

// Named locals wherever a coroutine takes a value: g++ 12 mishandles temporaries in the operand of co_await.

boost::asio::awaitable<Result<Raw>> SdoClient::read(ObjectAddress object, DataType type, unsigned tries,
                                                    TimePoint due) {
  SdoTransfer transfer = upload(object, byte_length(type));
  const Result<Bytes> bytes = co_await run(std::move(transfer), tries, due);
  co_return raw_of(bytes, object, type);
}

Result<Raw> SdoClient::raw_of(const Result<Bytes>& bytes, ObjectAddress object, DataType type) const {
  if (bytes.has_error()) {
    return bytes.error();
  }
  if (const std::optional<Raw> raw = decode_raw(type, bytes.value())) {
    return *raw;
  }
  Error too_short{.kind = ErrorKind::protocol,
                  .detail = "answer has " + std::to_string(bytes.value().size()) + " bytes, type " +
                            std::string(name_of(type)) + " needs " + std::to_string(byte_length(type))};
  return addressed(std::move(too_short), object);
}

boost::asio::awaitable<Result<void>> SdoClient::write(ObjectAddress object, DataType type, Raw raw) {
  SdoTransfer transfer = download(object, type, raw);
  const Result<Bytes> done = co_await run(std::move(transfer), 1 + channel_.settings.retries, Clock::now());
  co_return done.has_error() ? Result<void>(done.error()) : Result<void>();
}

boost::asio::awaitable<Result<SdoClient::Bytes>> SdoClient::run(SdoTransfer transfer, unsigned tries, TimePoint due) {
  const ObjectAddress object = transfer.object();
  SdoLine::Place place(line_, SdoLine::Kind::transfer, due);
  static_cast<void>(co_await place.wait_until(TimePoint::max()));
  bool certain = !unanswered_.contains(object);
  bool silent_to_block = false;
  unsigned given_up = 0;
  while (!place.called_off()) {
    const Unanswered::Proof proof = unanswered_.proof();
    if (!certain && Clock::now() < proof.from) {
      static_cast<void>(co_await place.step_aside(proof.from));
      certain = !unanswered_.contains(object);
      continue;
    }
    SdoExchange exchange(channel_, certain ? transfer : upload(proof.object), TransmitClass::sdo, TimePoint::max(),
                         unanswered_.any());
    co_await carry_out(exchange);
    const bool in_the_middle = exchange.transfer().in_segments();
    if (!certain && exchange.answered()) {
      certain = true;
      unanswered_.clear();
    } else if (exchange.gave_way() ? in_the_middle && ++given_up == kMostGivenUp
                                   : !exchange.timed_out() || --tries == 0) {
      if (silent_to_block && !exchange.error() && ++silent_to_block_ == kSilentToBlock) {
        on_block_unknown("does not answer to block transfer");
      }
      co_return result(exchange, object);
    }
    if (exchange.transfer().asks_for_block() && exchange.unanswered() && !exchange.gave_way() &&
        !exchange.disturbed()) {
      transfer.use_segments();  // Some servers say nothing where they know a request not.
      silent_to_block = true;
    }
    channel_.bus.sdo_budget().charge();
    // All tries together may take longer than a command has.
    const bool others_had_it = co_await place.step_aside(Clock::now());
    if (others_had_it || exchange.disturbed()) {
      certain = !unanswered_.contains(object);
    }
  }
  co_return addressed(*place.called_off(), object);
}

boost::asio::awaitable<Result<void>> SdoClient::send_command(SdoTransfer transfer, TimePoint deadline) {
  const ObjectAddress object = transfer.object();
  const TimePoint given = Clock::now();
  SdoLine::Place place(line_, SdoLine::Kind::command, given);
  if (exchange_ != nullptr && line_.held_by_transfer()) {
    exchange_->withdraw();  // What has not left, or takes many frames, must not hold a command back.
  }
  if (!co_await place.wait_until(deadline)) {
    co_return addressed(*place.called_off(), object);
  }
  // Half of its time at most: it is sent to a silent drive, too.
  const TimePoint now = Clock::now();
  const bool certain = co_await prove(object, now + (deadline - now) / 2);
  if (place.called_off()) {
    co_return addressed(*place.called_off(), object);
  }
  const Duration needed = std::min(write_times_.longest(), (deadline - given) / 2);
  if (deadline - Clock::now() < needed) {
    Error too_late{.kind = ErrorKind::timeout, .not_sent = true};
    too_late.detail = "not begun: too little time was left for the answer";
    co_return addressed(std::move(too_late), object);
  }
  send_abort_first(TransmitClass::command);
  SdoExchange exchange(channel_, std::move(transfer), TransmitClass::command, deadline, unanswered_.any());
  co_await carry_out(exchange);
  if (exchange.error() && exchange.error()->not_sent && place.called_off()) {
    co_return addressed(*place.called_off(), object);
  }
  co_return outcome(exchange, certain);
}

Result<SdoClient::Bytes> SdoClient::result(const SdoExchange& exchange, ObjectAddress object) const {
  if (!exchange.error()) {
    return exchange.transfer().data();
  }
  Error failure = *exchange.error();
  if (exchange.transfer().object() != object && exchange.unanswered()) {
    failure.detail = "not begun: an earlier request went unanswered, and now the drive is silent";
  }
  failure.object = object;
  return failure;
}

Result<void> SdoClient::outcome(const SdoExchange& command, bool certain) const {
  const std::optional<Error>& failure = command.error();
  const bool refused = failure && failure->kind == ErrorKind::refused;
  if (!certain && (!failure || refused)) {
    Error unclear{.kind = ErrorKind::timeout, .outcome_unknown = true, .detail = kMayBeOlder};
    return addressed(std::move(unclear), command.transfer().object());
  }
  if (!failure) {
    return {};
  }
  Error told = *failure;
  told.outcome_unknown = !refused && !told.not_sent;
  return told;
}

boost::asio::awaitable<bool> SdoClient::prove(ObjectAddress object, TimePoint until) {
  if (!unanswered_.contains(object)) {
    co_return true;
  }
  const Unanswered::Proof proof = unanswered_.proof();
  if (Clock::now() < proof.from) {
    co_return false;
  }
  channel_.bus.sdo_budget().charge();
  SdoExchange exchange(channel_, upload(proof.object), TransmitClass::sdo, until, true);
  co_await carry_out(exchange);
  if (exchange.answered()) {
    unanswered_.clear();
  }
  co_return exchange.answered();
}

boost::asio::awaitable<void> SdoClient::carry_out(SdoExchange& exchange) {
  const TimePoint begun = Clock::now();
  second_.on_request(exchange.transfer().object());
  exchange_ = &exchange;
  co_await exchange.run();
  exchange_ = nullptr;
  if (!exchange.error() && exchange.transfer().is_expedited_download()) {
    write_times_.note(Clock::now() - begun);
  }
  const ObjectAddress object = exchange.transfer().object();
  if (exchange.transfer().block_accepted()) {
    silent_to_block_ = 0;
  }
  if (exchange.transfer().block_refused()) {
    on_block_unknown("refuses block transfer");
  }
  if (exchange.unanswered()) {
    answered_ = answered_ && (exchange.gave_way() || exchange.disturbed());
    unanswered_.note(object, exchange.transfer().is_upload());
  } else if (exchange.answered() && !unanswered_.contains(object)) {
    unanswered_.clear();
  }
  if (exchange.transfer().in_segments() && exchange.timed_out()) {
    send_abort(abort_request(object, exchange.gave_way() ? kAbortGeneral : kAbortTimedOut));
  }
}

SdoSettings SdoClient::settings_of_whole() const {
  SdoSettings settings = channel_.settings;
  settings.block = settings.block && !block_unknown_;
  return settings;
}

void SdoClient::on_block_unknown(std::string_view how) {
  if (!std::exchange(block_unknown_, true) && remark_handler_) {
    remark_handler_("the drive " + std::string(how) + " (sdo.block), so segments are used");
  }
}

void SdoClient::withdraw_commands() {
  line_.call_off({SdoLine::Kind::command}, {.kind = ErrorKind::offline,
                                            .not_sent = true,
                                            .detail = "withdrawn: the drive left operational, or is about to"});
  if (exchange_ != nullptr && exchange_->is_command()) {
    exchange_->withdraw();
  }
}

void SdoClient::interrupt() {
  const Error why{.kind = ErrorKind::offline, .detail = kInterrupted};
  line_.call_off({SdoLine::Kind::transfer, SdoLine::Kind::command}, why);
  answered_ = false;
  block_unknown_ = false;
  silent_to_block_ = 0;
  second_.forget();
  ++interruptions_;
  abort_.reset();
  if (exchange_ != nullptr && !(exchange_->is_stop() && exchange_->waits_to_leave())) {
    exchange_->interrupt(why);
  }
}

void SdoClient::close() {
  const Error why{.kind = ErrorKind::offline, .not_sent = true, .detail = kInterrupted};
  line_.call_off({SdoLine::Kind::stop}, why);
  interrupt();
  if (exchange_ != nullptr) {
    exchange_->interrupt(why);
  }
}

bool SdoClient::may_still_act(ObjectAddress object) const noexcept {
  const bool under_way =
      exchange_ != nullptr && !exchange_->transfer().is_upload() && exchange_->transfer().object() == object;
  return under_way || unanswered_.count(object).downloads > 0;
}

SdoTransfer SdoClient::download(ObjectAddress object, DataType type, Raw raw) const {
  std::array<std::uint8_t, 8> data{};
  const unsigned length = encode_raw(type, raw, data);
  return SdoTransfer::download(channel_.settings, object, std::span<const std::uint8_t>(data).first(length));
}

void SdoClient::send_abort(const SdoFrame& abort, TransmitClass transmit_class) {
  aborted_ = abort;
  const Frame frame = sdo_request_frame(channel_.node, abort);
  abort_ = channel_.bus.send(transmit_class, frame, Clock::now() + TransmitQueue::kLifeTime);
}

Error SdoClient::addressed(Error error, ObjectAddress object) const {
  error.node = channel_.node;
  error.object = object;
  return error;
}

}  // namespace canopen
