#include "canopen/node/rpdo_sender.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "canopen/bus/transmission.h"

namespace canopen {

/// One who wants to send, in the line of all who do.
class RpdoSender::Turn {
 public:
  explicit Turn(RpdoSender& sender) : sender_(sender) { sender_.users_.push_back(this); }
  ~Turn() {
    std::erase(sender_.users_, this);
    sender_.turn_event_.notify();
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

  [[nodiscard]] bool mine() const noexcept { return sender_.users_.front() == this; }

  /// Its RPDO, while that waits for its departure.
  struct Sending {
    const Entry* entry;
    bool relies_on_known;  ///< It carries values that were commanded earlier.
    Transmission transmission;

    Sending(const Entry* what, bool relies, Bus& bus, const Frame& frame, TimePoint deadline)
        : entry(what), relies_on_known(relies), transmission(bus, TransmitClass::command, frame, deadline) {}
  };
  std::optional<Sending> sending;
  bool ceased = false;  ///< cease() was called since it came.
  bool voided = false;  ///< make_void() was called since it is under way.

 private:
  RpdoSender& sender_;
};

RpdoSender::RpdoSender(const boost::asio::any_io_executor& executor, Bus& bus, std::uint8_t node,
                       std::span<const PdoSettings> rpdos)
    : executor_(executor), bus_(bus), node_(node), turn_event_(executor) {
  entries_.reserve(rpdos.size());  // The repetitions keep references.
  for (const PdoSettings& settings : rpdos) {
    Entry& entry =
        entries_.emplace_back(Entry{Rpdo(settings), Rpdo(settings), repeat_time(settings), nullptr, TimePoint{}});
    entry.repetition = std::make_unique<WakeUp>(executor_, [this, &entry] { repeat(entry); });
  }
}

std::uint16_t RpdoSender::rpdo_of(ObjectAddress object) const noexcept {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.rpdo.maps(object); });
  return found == entries_.end() ? std::uint16_t{0} : found->rpdo.number();
}

bool RpdoSender::complete(std::uint16_t number, std::span<const ObjectValue> fields) const noexcept {
  const Entry* entry = find(number);
  return entry != nullptr && entry->rpdo.complete(fields);
}

boost::asio::awaitable<Result<void>> RpdoSender::send(std::uint16_t number, std::vector<ObjectValue> fields,
                                                      TimePoint deadline) {
  Entry* entry = find(number);
  if (entry == nullptr) {
    co_return error(ErrorKind::unknown, "no RPDO" + std::to_string(number));
  }
  Turn turn(*this);
  while (!turn.mine() && !turn.ceased && Clock::now() < deadline) {
    co_await turn_event_.wait_until(deadline);
  }
  if (turn.ceased) {
    co_return error(ErrorKind::offline, "the drive was lost, rebooted, or left operational");
  }
  if (!turn.mine()) {
    co_return error(ErrorKind::timeout, "not begun: other RPDOs were on their way");
  }
  co_return co_await transmit(turn, *entry, std::move(fields), deadline);
}

boost::asio::awaitable<Result<void>> RpdoSender::transmit(Turn& turn, Entry& entry, std::vector<ObjectValue> fields,
                                                          TimePoint deadline) {
  const std::optional<Rpdo::Draft> draft = entry.rpdo.build(fields);
  if (!draft) {
    co_return error(ErrorKind::incomplete,
                    "RPDO" + std::to_string(entry.rpdo.number()) + " has fields that nobody commanded");
  }
  entry.repeated.reset();  // It is older.
  Turn::Sending& sending = turn.sending.emplace(&entry, !entry.blank.complete(fields), bus_, draft->frame, deadline);
  Result<void> left = co_await sending.transmission.result();
  turn.sending.reset();
  if (left.has_value()) {
    entry.rpdo.confirm(*draft, fields);
    if (entry.repeat > Duration::zero() && entry.rpdo.last_confirmed()) {
      entry.repetition->arm(Clock::now() + entry.repeat);
    }
    co_return left;
  }
  Error failure = left.error();
  failure.node = node_;
  if (failure.outcome_unknown) {
    entry.rpdo.outcome_unknown(fields);
  } else if (turn.ceased) {
    failure = error(ErrorKind::offline, "withdrawn: the drive was lost, rebooted, or left operational");
  } else if (turn.voided) {
    failure = error(ErrorKind::incomplete, "withdrawn: the motor came to a stop, which makes earlier commands void");
  }
  co_return failure;
}

void RpdoSender::hold(ObjectAddress object) noexcept {
  for (Entry& entry : entries_) {
    if (entry.rpdo.maps(object)) {
      entry.repeated.reset();  // One that waits would undo the write that is about to overtake it.
    }
    const TimePoint now = Clock::now();
    // Not again before a repetition has gone: of a row of writes each would hold it on.
    if (entry.rpdo.maps(object) && now >= entry.held_until + entry.repeat) {
      entry.held_until = now + entry.repeat;
    }
  }
}

void RpdoSender::note(const ObjectValue& value) noexcept {
  for (Entry& entry : entries_) {
    entry.rpdo.note(value);
    if (entry.rpdo.maps(value.object)) {
      entry.repeated.reset();
    }
    if (entry.rpdo.maps(value.object) && entry.held_until > Clock::now()) {
      entry.held_until = Clock::now();
    }
  }
}

void RpdoSender::forget(ObjectAddress object) noexcept {
  for (Entry& entry : entries_) {
    if (entry.rpdo.maps(object)) {
      entry.repeated.reset();
    }
    entry.rpdo.forget(object);
  }
}

void RpdoSender::cease() {
  for (Entry& entry : entries_) {
    entry.rpdo.make_void();
    entry.repetition->cancel();
    entry.repeated.reset();
  }
  for (Turn* turn : users_) {
    turn->ceased = true;
  }
  if (Turn* turn = under_way()) {
    turn->sending->transmission.withdraw();
  }
  turn_event_.notify();
}

void RpdoSender::make_void(bool keep_repeating) {
  for (Entry& entry : entries_) {
    if (keep_repeating) {
      entry.rpdo.make_void_but_repeat();
    } else {
      entry.rpdo.make_void();
      entry.repetition->cancel();
      entry.repeated.reset();
    }
  }
  if (Turn* turn = under_way()) {
    turn->voided = true;
    if (turn->sending->relies_on_known) {
      turn->sending->transmission.withdraw();
    }
  }
}

boost::asio::awaitable<void> RpdoSender::until_idle() {
  while (!users_.empty()) {
    co_await turn_event_.wait_until(TimePoint::max());
  }
}

void RpdoSender::repeat(Entry& entry) {
  const std::optional<Frame> frame = entry.rpdo.last_confirmed();
  if (!frame) {
    return;
  }
  // While a command of this RPDO waits, or its departure is not yet noted, the last confirmed frame is the older one.
  const Turn* turn = under_way();
  const bool commanded = turn != nullptr && turn->sending->entry == &entry;
  if (!commanded && Clock::now() >= entry.held_until) {
    // One that waits keeps its place, or drives behind many others would never hear theirs.
    if (!entry.repeated.waiting() || entry.repeated_frame != *frame) {
      entry.repeated.reset();
      entry.repeated_frame = *frame;
      entry.repeated = bus_.send(TransmitClass::repetition, *frame, Clock::now() + TransmitQueue::kLifeTime);
    }
  }
  entry.repetition->arm(Clock::now() + entry.repeat);
}

RpdoSender::Turn* RpdoSender::under_way() const noexcept {
  return !users_.empty() && users_.front()->sending ? users_.front() : nullptr;
}

RpdoSender::Entry* RpdoSender::find(std::uint16_t number) noexcept {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.rpdo.number() == number; });
  return found == entries_.end() ? nullptr : &*found;
}

const RpdoSender::Entry* RpdoSender::find(std::uint16_t number) const noexcept {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.rpdo.number() == number; });
  return found == entries_.end() ? nullptr : &*found;
}

Error RpdoSender::error(ErrorKind kind, std::string detail) const {
  Error error;
  error.kind = kind;
  error.node = node_;
  error.detail = std::move(detail);
  return error;
}

}  // namespace canopen
