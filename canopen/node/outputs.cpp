#include "canopen/node/outputs.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "canopen/bus/transmission.h"

namespace canopen {

/// One who wants to send, in the line of all who do.
class Outputs::Turn {
 public:
  Turn(Outputs& owner, Entry& what) : entry(what), owner_(owner) { owner_.turns_.push_back(this); }
  ~Turn() {
    std::erase(owner_.turns_, this);
    owner_.turn_event_.notify();
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

  [[nodiscard]] bool mine() const noexcept { return owner_.turns_.front() == this; }
  /// It is not to leave any more, unless the kernel already has it.
  void refuse(Error why) {
    refusal = std::move(why);
    if (transmission) {
      transmission->withdraw();
    }
  }

  Entry& entry;
  std::optional<Error> refusal;
  std::optional<Transmission> transmission;  ///< While its RPDO waits for its departure.

 private:
  Outputs& owner_;
};

Outputs::Entry::Entry(Outputs& owner, const boost::asio::any_io_executor& executor, const PdoSettings& settings)
    : rpdo(settings), period(repeat_time(settings)), wake_up(executor, [&owner, this] { owner.on_due(*this); }) {}

Outputs::Outputs(const boost::asio::any_io_executor& executor, Bus& bus, std::uint8_t node,
                 std::span<const PdoSettings> rpdos)
    : bus_(bus), node_(node), turn_event_(executor) {
  for (const PdoSettings& settings : rpdos) {
    entries_.emplace_back(*this, executor, settings);
  }
}

std::uint16_t Outputs::rpdo_of(ObjectAddress object) const noexcept {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.rpdo.maps(object); });
  return found == entries_.end() ? std::uint16_t{0} : found->rpdo.number();
}

bool Outputs::complete(std::uint16_t number, std::span<const ObjectValue> fields) const noexcept {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& entry) { return entry.rpdo.number() == number && entry.rpdo.complete(fields); });
}

boost::asio::awaitable<Result<void>> Outputs::send(std::uint16_t number, std::vector<ObjectValue> fields,
                                                   TimePoint deadline) {
  const auto entry =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& each) { return each.rpdo.number() == number; });
  if (entry == entries_.end()) {
    co_return error(ErrorKind::unknown, "no RPDO" + std::to_string(number));
  }
  Turn turn(*this, *entry);
  while (!turn.mine() && !turn.refusal && Clock::now() < deadline) {
    co_await turn_event_.wait_until(deadline);
  }
  if (turn.refusal) {
    co_return *turn.refusal;
  }
  if (!turn.mine()) {
    co_return error(ErrorKind::timeout, "not begun: other RPDOs were on their way");
  }
  co_return co_await transmit(turn, fields, deadline);
}

boost::asio::awaitable<Result<void>> Outputs::transmit(Turn& turn, std::span<const ObjectValue> fields,
                                                       TimePoint deadline) {
  Entry& entry = turn.entry;
  const std::optional<Frame> frame = entry.rpdo.begin(fields);
  if (!frame) {
    co_return error(ErrorKind::incomplete,
                    "RPDO" + std::to_string(entry.rpdo.number()) + " has fields that nobody commanded");
  }
  entry.repetition.reset();  // It is older.
  Result<void> left = co_await turn.transmission.emplace(bus_, TransmitClass::command, *frame, deadline).result();
  turn.transmission.reset();
  if (left.has_value()) {
    entry.rpdo.left();
    entry.due = Clock::now() + entry.period;
    entry.pause_end = {};
  } else if (left.error().outcome_unknown) {
    entry.rpdo.outcome_unknown();
  } else if (turn.refusal) {
    left = *turn.refusal;
  }
  if (entry.period > Duration::zero() && entry.rpdo.repeated()) {
    entry.wake_up.arm(entry.due);
  }
  if (left.has_error()) {
    Error failure = left.error();
    failure.node = node_;
    left = failure;
  }
  co_return left;
}

void Outputs::hold(ObjectAddress object) {
  const TimePoint now = Clock::now();
  for (Entry& entry : entries_) {
    if (!entry.rpdo.maps(object)) {
      continue;
    }
    if (entry.pause_end == TimePoint{}) {
      entry.pause_end = now + entry.period;
    }
    if (now < entry.pause_end) {
      if (entry.repetition.waiting()) {
        entry.due = now;
        entry.wake_up.arm(entry.pause_end);
      }
      entry.repetition.reset();  // It would undo the write that is about to overtake it.
    }
  }
}

void Outputs::note(const ObjectValue& value) {
  for (Entry& entry : entries_) {
    if (!entry.rpdo.maps(value.object)) {
      continue;
    }
    entry.rpdo.note(value);
    if (entry.repetition.waiting() || entry.pause_end == TimePoint{} || Clock::now() >= entry.due) {
      repeat(entry);
    } else {
      entry.pause_end = {};
    }
  }
}

void Outputs::forget(ObjectAddress object) {
  for (Entry& entry : entries_) {
    if (entry.rpdo.maps(object)) {
      entry.rpdo.forget(object);
      entry.repetition.reset();
    }
  }
}

void Outputs::cease() {
  make_void(false);
  for (Turn* turn : turns_) {
    turn->refuse(error(ErrorKind::offline, "withdrawn: the drive was lost, rebooted, or left operational"));
  }
  turn_event_.notify();
}

void Outputs::make_void(bool keep_repeating) {
  for (Entry& entry : entries_) {
    entry.rpdo.make_void(keep_repeating);
    if (!keep_repeating) {
      entry.repetition.reset();
    }
  }
  Turn* turn = under_way();
  if (turn != nullptr && turn->entry.rpdo.relies_on_known()) {
    turn->refuse(
        error(ErrorKind::incomplete, "withdrawn: the motor came to a stop, which makes earlier commands void"));
  }
}

boost::asio::awaitable<void> Outputs::until_idle() {
  while (!turns_.empty()) {
    co_await turn_event_.wait_until(TimePoint::max());
  }
}

void Outputs::on_due(Entry& entry) {
  if (Clock::now() < entry.pause_end) {
    entry.wake_up.arm(entry.pause_end);
  } else {
    repeat(entry);
  }
}

void Outputs::repeat(Entry& entry) {
  const std::optional<Frame> frame = entry.rpdo.repeated();
  const Turn* turn = under_way();
  // While a command of this RPDO waits, or its departure is not yet noted, what was repeated is older. Its end goes on.
  if (!frame || entry.period == Duration::zero() || (turn != nullptr && &turn->entry == &entry)) {
    return;
  }
  // One that waits keeps its place, or drives behind many others would never hear theirs.
  if (!entry.repetition.waiting() || entry.repeated != *frame) {
    entry.repetition.reset();
    entry.repeated = *frame;
    const auto told = [&entry](Departure departure) {
      entry.pause_end = departure == Departure::left ? TimePoint{} : entry.pause_end;
    };
    entry.repetition = bus_.send(TransmitClass::repetition, *frame, Clock::now() + TransmitQueue::kLifeTime, told);
  }
  entry.due = Clock::now() + entry.period;
  entry.wake_up.arm(entry.due);
}

Outputs::Turn* Outputs::under_way() const noexcept {
  return !turns_.empty() && turns_.front()->transmission ? turns_.front() : nullptr;
}

Error Outputs::error(ErrorKind kind, std::string detail) const {
  Error error;
  error.kind = kind;
  error.node = node_;
  error.detail = std::move(detail);
  return error;
}

}  // namespace canopen
