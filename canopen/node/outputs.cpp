#include "canopen/node/outputs.h"

#include <algorithm>
#include <array>
#include <utility>

#include "canopen/bus/transmission.h"

namespace canopen {

/// An RPDO that somebody sends, where it can be withdrawn.
class Outputs::Sending {
 public:
  Sending(Outputs& owner, Entry& what, const Frame& frame, TransmitClass transmit_class, TimePoint deadline)
      : entry(what),
        stops(transmit_class == TransmitClass::stop),
        owner_(owner),
        transmission_(owner.bus_, transmit_class, frame, deadline) {
    owner_.sendings_.push_back(this);
  }
  ~Sending() {
    std::erase(owner_.sendings_, this);
    owner_.idle_.notify();
  }
  Sending(const Sending&) = delete;
  Sending& operator=(const Sending&) = delete;

  boost::asio::awaitable<Result<void>> result() { return transmission_.result(); }
  void withdraw() { transmission_.withdraw(); }

  Entry& entry;
  bool stops;
  std::optional<Error> refusal;  ///< Why it was withdrawn, where that is to be told.

 private:
  Outputs& owner_;
  Transmission transmission_;
};

Outputs::Entry::Entry(Outputs& owner, const boost::asio::any_io_executor& executor, const PdoSettings& of)
    : settings(of),
      plan(settings.mapping),
      period(repeat_time(settings)),
      wake_up(executor, [&owner, this] { owner.on_due(*this); }) {}

Outputs::Outputs(const boost::asio::any_io_executor& executor, Bus& bus, std::uint8_t node,
                 std::span<const PdoSettings> rpdos, Image image)
    : bus_(bus), node_(node), image_(std::move(image)), idle_(executor) {
  for (const PdoSettings& settings : rpdos) {
    entries_.emplace_back(*this, executor, settings);
  }
}

boost::asio::awaitable<Result<void>> Outputs::send(std::uint16_t number, Values values, TransmitClass transmit_class,
                                                   TimePoint deadline) {
  const auto entry =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& each) { return each.settings.number == number; });
  if (entry == entries_.end()) {
    co_return error(ErrorKind::unknown, "no RPDO" + std::to_string(number));
  }
  const std::optional<Frame> frame = frame_of(*entry, values);
  if (!frame) {
    co_return error(ErrorKind::incomplete, "RPDO" + std::to_string(number) + " has fields that nobody commanded");
  }
  entry->repetition.reset();  // It is older.
  Sending sending(*this, *entry, *frame, transmit_class, deadline);
  Result<void> left = co_await sending.result();
  if (left.has_value()) {
    entry->repeats = true;
    entry->due = Clock::now() + entry->period;
    entry->pause_end = {};
  } else {
    // Where nobody knows whether it has left, repeating the one before might undo it.
    entry->repeats = entry->repeats && !left.error().outcome_unknown;
    Error failure = sending.refusal && left.error().not_sent ? *sending.refusal : left.error();
    failure.node = node_;
    left = failure;
  }
  if (entry->repeats && entry->period > Duration::zero()) {
    entry->wake_up.arm(entry->due);
  }
  co_return left;
}

void Outputs::withdraw() {
  for (Sending* sending : sendings_) {
    if (!sending->stops) {
      sending->withdraw();
    }
  }
}

void Outputs::hold(ObjectAddress object) {
  const TimePoint now = Clock::now();
  for (Entry& entry : entries_) {
    if (!maps(entry, object)) {
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

void Outputs::refresh(ObjectAddress object) {
  for (Entry& entry : entries_) {
    if (!maps(entry, object)) {
      continue;
    }
    if (entry.repetition.waiting() || entry.pause_end == TimePoint{} || Clock::now() >= entry.due) {
      repeat(entry);
    } else {
      entry.pause_end = {};
    }
  }
}

void Outputs::look_again() {
  for (Entry& entry : entries_) {
    if (entry.repetition.waiting() && wanted(entry) != entry.repeated) {
      repeat(entry);
    }
  }
}

void Outputs::cease() {
  for (Entry& entry : entries_) {
    entry.repeats = false;
    entry.repetition.reset();
  }
  for (Sending* sending : sendings_) {
    sending->refusal = error(ErrorKind::offline, "withdrawn: the drive was lost, rebooted, or left operational");
    sending->refusal->not_sent = true;
    sending->withdraw();
  }
}

boost::asio::awaitable<void> Outputs::until_idle() {
  while (!sendings_.empty()) {
    co_await idle_.wait_until(TimePoint::max());
  }
}

bool Outputs::maps(const Entry& entry, ObjectAddress object) noexcept {
  const auto& mapping = entry.settings.mapping;
  return std::any_of(mapping.begin(), mapping.end(),
                     [&](const MappedObject& mapped) { return is_commanded(mapped) && mapped.object == object; });
}

std::optional<Frame> Outputs::frame_of(const Entry& entry, std::span<const ObjectValue> values) {
  const auto& mapping = entry.settings.mapping;
  if (mapping.empty() ||
      !std::all_of(values.begin(), values.end(), [&](const auto& value) { return maps(entry, value.object); })) {
    return std::nullopt;
  }
  std::array<Raw, kMaxPdoFields> raw{};
  for (std::size_t i = 0; i < mapping.size(); ++i) {
    const auto value = std::find_if(values.begin(), values.end(),
                                    [&](const ObjectValue& each) { return each.object == mapping[i].object; });
    if (is_unnamed(mapping[i]) || (is_commanded(mapping[i]) && value == values.end())) {
      return std::nullopt;
    }
    raw[i] = is_commanded(mapping[i]) ? value->raw : 0;
  }
  const auto bytes = entry.plan.encode(std::span(raw).first(mapping.size()));
  return make_frame(entry.settings.cob_id, std::span(bytes).first(entry.plan.byte_count()));
}

std::optional<Frame> Outputs::wanted(const Entry& entry) const {
  if (!entry.repeats || entry.period == Duration::zero()) {
    return std::nullopt;
  }
  const std::optional<Values> values = image_(entry.settings.number);
  return values ? frame_of(entry, *values) : std::nullopt;
}

bool Outputs::sends(const Entry& entry) const noexcept {
  return std::any_of(sendings_.begin(), sendings_.end(),
                     [&](const Sending* sending) { return &sending->entry == &entry; });
}

void Outputs::on_due(Entry& entry) {
  if (Clock::now() < entry.pause_end) {
    entry.wake_up.arm(entry.pause_end);
  } else {
    repeat(entry);
  }
}

void Outputs::repeat(Entry& entry) {
  const std::optional<Frame> frame = wanted(entry);
  if (!frame) {
    entry.repetition.reset();
    return;
  }
  // While a command of this RPDO waits, or its departure is not yet noted, what was repeated is older. Its end goes on.
  if (sends(entry)) {
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

Error Outputs::error(ErrorKind kind, std::string detail) const {
  Error error;
  error.kind = kind;
  error.node = node_;
  error.detail = std::move(detail);
  return error;
}

}  // namespace canopen
