// Stops of an SDO client: before everything else, and confirmed by no answer that may be that to an older request.

#include <algorithm>
#include <string>

#include "canopen/bus/bus.h"
#include "canopen/sdo/client.h"

namespace canopen {
namespace {

// So long what is under way may hold a stop back: some drives need 100 ms for an answer, and such a one still counts.
constexpr Duration kStopPatience = std::chrono::milliseconds(101);

// Half of the stop's own time at most.
TimePoint end_of_patience(TimePoint deadline) {
  const TimePoint now = Clock::now();
  return now + std::min(kStopPatience, (deadline - now) / 2);
}

}  // namespace

boost::asio::awaitable<Result<void>> SdoClient::write_stop(ObjectAddress object, DataType type, Raw raw,
                                                           TimePoint deadline, unsigned most_sent,
                                                           const StopLimit& limit) {
  const std::uint64_t life = interruptions_;
  SdoLine::Place place(line_, SdoLine::Kind::stop, Clock::now());
  make_way(deadline);
  if (!co_await place.wait_until(deadline)) {
    co_return addressed(*place.called_off(), object);
  }
  send_abort_first(TransmitClass::stop);
  Unanswered::Count older = unanswered_.count(object);
  bool disturbed = false;
  for (unsigned sent = 1;; ++sent) {
    SdoExchange exchange(channel_, download(object, type, raw), TransmitClass::stop, deadline, unanswered_.any());
    co_await carry_out_stop(exchange, limit);
    if (exchange.answered() && settles(exchange, older)) {
      for (unsigned others = 1; others < sent; ++others) {
        unanswered_.note(object, false);
      }
      co_return outcome(exchange, true);
    }
    const bool again = exchange.answered() || (exchange.disturbed() && !disturbed);
    // Once to a node that was lost or booted meanwhile, and to none that is served no more.
    const unsigned most = life == interruptions_ ? most_sent : 1;
    if (!again || place.called_off() || sent >= most || Clock::now() >= std::min(deadline, limit.until)) {
      const bool never_sent = sent == 1 && exchange.error() && exchange.error()->not_sent;
      co_return never_sent ? *exchange.error() : not_confirmed(exchange);
    }
    if (exchange.disturbed()) {
      disturbed = true;
      older = unanswered_.count(object);
    }
  }
}

boost::asio::awaitable<Result<Raw>> SdoClient::read_for_stop(ObjectAddress object, DataType type, TimePoint deadline,
                                                             const StopLimit& limit) {
  SdoLine::Place place(line_, SdoLine::Kind::stop, Clock::now());
  make_way(deadline);
  if (!co_await place.wait_until(deadline)) {
    co_return addressed(*place.called_off(), object);
  }
  send_abort_first(TransmitClass::stop);
  // The answer to an older read of it may come first; the next one is ours, or as new.
  const int reads = unanswered_.contains(object) ? 2 : 1;
  Result<Bytes> bytes = Error{};
  for (int read = 0; read < reads && (read == 0 || bytes.has_value()); ++read) {
    SdoExchange exchange(channel_, upload(object, byte_length(type)), TransmitClass::stop, deadline, unanswered_.any());
    co_await carry_out_stop(exchange, limit);
    bytes = result(exchange, object);
  }
  co_return raw_of(bytes, object, type);
}

boost::asio::awaitable<void> SdoClient::carry_out_stop(SdoExchange& exchange, const StopLimit& limit) {
  if (limit.until != kNever) {
    exchange.hurry(limit.until);
  }
  stop_ = &limit;
  co_await carry_out(exchange);
  stop_ = nullptr;
}

void SdoClient::hurry_stop(StopLimit& limit, TimePoint deadline) {
  limit.until = std::min(limit.until, end_of_patience(deadline));
  if (stop_ == &limit) {
    exchange_->hurry(limit.until);
  }
}

/// A server in the middle of a segmented or block transfer would take the stop or command for a protocol error of that
/// one, and refuse it (CiA 301 §7.2.4.3). Of the same class and COB-ID, and older, it leaves first.
void SdoClient::send_abort_first(TransmitClass transmit_class) {
  if (abort_.waiting()) {
    send_abort(aborted_, transmit_class);
  }
}

void SdoClient::make_way(TimePoint deadline) {
  if (exchange_ == nullptr || exchange_->is_stop()) {
    return;
  }
  line_.call_off_held_command({.kind = ErrorKind::timeout, .not_sent = true, .detail = "not sent: a stop goes first"});
  exchange_->hurry(end_of_patience(deadline));
}

bool SdoClient::settles(const SdoExchange& stop, Unanswered::Count& older) {
  const ObjectAddress object = stop.transfer().object();
  const bool confirms = !stop.error();
  // Uploads are answered otherwise, but aborted alike.
  const bool to_download = confirms && !channel_.settings.accept_upload_style_write_answer;
  if ((to_download ? older.downloads : older.all) == 0) {
    unanswered_.clear();
    return true;
  }
  older.take_one(to_download);
  unanswered_.note(object, false);
  unanswered_.take_one(object, to_download);
  return false;
}

Error SdoClient::not_confirmed(const SdoExchange& stop) const {
  const std::optional<Error>& why = stop.error();
  std::string detail = "sent, not confirmed";
  ErrorKind kind = ErrorKind::timeout;
  if (stop.answered()) {
    detail.append(": ").append(kMayBeOlder);
  } else if (why) {
    kind = why->kind == ErrorKind::offline ? ErrorKind::offline : ErrorKind::timeout;
    detail.append(": ").append(why->detail);
  }
  Error error{.kind = kind, .outcome_unknown = true, .detail = std::move(detail)};
  return addressed(std::move(error), stop.transfer().object());
}

}  // namespace canopen
