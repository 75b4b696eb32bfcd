#include "canopen/survey/bus_survey.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/cob_id.h"
#include "canopen/sdo/frames.h"

namespace canopen {
namespace {

constexpr Duration kStep = std::chrono::seconds(1);
constexpr Duration kMinute = std::chrono::minutes(1);
// A look each second, and one that comes late.
constexpr Duration kAgeTold = std::chrono::seconds(3);
constexpr std::uint32_t kNodeMask = 0x7F;

// Nothing of the kind: long before anything that is asked for.
constexpr TimePoint kNotYet = TimePoint::min() + std::chrono::hours(1);

bool is_within(TimePoint at, TimePoint now, Duration time) noexcept {
  return at > now - time;
}

template <std::size_t N>
void put_first(std::array<TimePoint, N>& times, TimePoint at) noexcept {
  std::copy_backward(times.begin(), times.end() - 1, times.end());
  times.front() = at;
}

}  // namespace

const NodeHealth* worst_node(const BusHealth& health) noexcept {
  const NodeHealth* worst = nullptr;
  for (const NodeHealth& node : health.nodes) {
    const std::optional<double> margin = node.worst_margin();
    if (margin && (worst == nullptr || *margin < *worst->worst_margin())) {
      worst = &node;
    }
  }
  return worst;
}

std::string suspicion_text(const BusHealth& health) {
  if (!health.suspicion) {
    return {};
  }
  if (health.suspicion_age < kAgeTold) {
    return health.suspicion->text();
  }
  const auto age = std::chrono::floor<std::chrono::seconds>(health.suspicion_age).count();
  return health.suspicion->text(", seen until " + std::to_string(age) + " s ago");
}

BusSurvey::BusSurvey(const boost::asio::any_io_executor& executor, Bus& bus, Handlers handlers)
    : bus_(bus), handlers_(std::move(handlers)), hour_(hour_of(Clock::now())), timer_(executor, [this] { look(); }) {
  forget_disturbances();
  bursts_.set_bitrate(bus_.bitrate().value_or(0));
  subscriptions_.push_back(bus_.add_tap(*this));
  subscriptions_.push_back(bus_.subscribe_state([this](const BusState& state) { on_state(state); }));
  subscriptions_.push_back(
      bus_.subscribe_timing([this](const BitTiming& timing) { bursts_.set_bitrate(timing.bitrate); }));
}

void BusSurvey::start() {
  second_began_ = Clock::now();
  timer_.arm(Clock::now() + kStep);
}

void BusSurvey::on_frame(const Received& received, FrameOrigin origin) {
  const Frame& frame = received.frame;
  if (origin == FrameOrigin::driver) {
    traffic_.add_error(error_counts_of(frame));
    return;
  }
  const Moment moment{.at = received.at, .hour = hour_, .unbroken = unbroken_};
  bursts_.hear(moment);
  const bool ours = origin == FrameOrigin::ourselves;
  if (!ours) {
    if (!heard_) {
      forget_disturbances();
      heard_ = true;
    }
    traffic_.add_received();
  }
  if (frame.extended || frame.remote) {
    return;
  }
  const auto node = static_cast<std::uint8_t>(frame.id & kNodeMask);
  switch (frame.id & ~kNodeMask) {
    case kErrorControlBase:
      if (!ours && nodes_.hear_error_control(node, frame, moment)) {
        periods_.break_node(node);
      }
      break;
    case kSdoRequestBase:
      nodes_.hear_request(node, frame, ours, moment);
      break;
    case kSdoAnswerBase:
      nodes_.hear_answer(node, moment);
      break;
    default:
      break;
  }
  periods_.hear(frame.id, moment);
}

void BusSurvey::on_frames_lost(std::uint32_t /*count*/) {
  ++unbroken_;
}

void BusSurvey::on_state(const BusState& state) {
  const TimePoint now = Clock::now();
  const BusState before = std::exchange(state_, state);
  if (state.up() != before.up()) {
    ++unbroken_;
  }
  if (before.condition == BusCondition::down) {
    saw_it_come_up_ = saw_it_go_down_;
    heard_ = false;
    forget_disturbances();
  }
  if (state.condition == BusCondition::down && before.condition != BusCondition::down) {
    saw_it_go_down_ = true;
    if (const std::optional<Suspicion> ended = suspicion_.drop(); ended && handlers_.ended) {
      handlers_.ended(*ended);
    }
  }
  if (state.condition == BusCondition::bus_off && before.condition != BusCondition::bus_off) {
    put_first(bus_offs_, now);
  }
  const bool well = state.condition == BusCondition::error_active;
  if (well && unwell_since_) {
    put_first(excursions_, *unwell_since_);
  }
  if (well || state.condition == BusCondition::down) {
    unwell_since_.reset();
  } else if (before.condition == BusCondition::error_active) {
    unwell_since_ = now;
  }
}

void BusSurvey::forget_disturbances() noexcept {
  traffic_ = {};
  unwell_since_.reset();
  excursions_.fill(kNotYet);
  bus_offs_.fill(kNotYet);
}

void BusSurvey::look() {
  const TimePoint now = Clock::now();
  hour_ = hour_of(now);
  const Known known = handlers_.known();
  set_served(known.served);
  bursts_.settle(now, hour_);
  keep_figures();
  if (known.troubles.transmit == TransmitTrouble::not_acknowledged) {
    // Drives without power take the controller away from error-active too (ISO 11898-1), and no wire is bad.
    unwell_since_.reset();
  }
  const SuspicionHold::Change change = suspicion_.look(judge(signs(known)), now, wall_now());
  // By time and not by looks: a process that was stopped looks once for all of it.
  const auto passed = (now - second_began_) / kStep;
  second_began_ += passed * kStep;
  traffic_.pass(static_cast<std::size_t>(passed));
  if (change.ended && handlers_.ended) {
    handlers_.ended(*change.ended);
  }
  if (change.began && handlers_.began) {
    handlers_.began(*change.began, change.displaced);
  }
  timer_.arm(now + kStep);
}

void BusSurvey::set_served(const NodeSet& served) {
  const NodeSet lost = std::exchange(served_, served) & ~served;
  for (std::size_t node = 1; lost.any() && node < lost.size(); ++node) {
    if (lost[node]) {
      periods_.break_node(static_cast<std::uint8_t>(node));
    }
  }
  nodes_.set_served(served);
}

void BusSurvey::keep_figures() {
  const BusStatistics& statistics = bus_.statistics();
  errors_.add(statistics.error_frames, hour_);
  if (state_.condition == BusCondition::down) {
    return;
  }
  transmit_errors_.add(state_.transmit_errors, hour_);
  receive_errors_.add(state_.receive_errors, hour_);
  if (statistics.bitrate != 0) {
    load_.add(statistics.load_per_mille, hour_);
  }
}

Signs BusSurvey::signs(const Known& known) const {
  const TimePoint now = Clock::now();
  const BusStatistics& statistics = bus_.statistics();
  const bool full = known.troubles.overload || known.troubles.transmit == TransmitTrouble::stuck;
  return {.state = state_,
          .troubles = known.troubles,
          .lately = traffic_.of_last(Signs::kLately),
          .minute = traffic_.of_last(RecentTraffic::kSeconds),
          .heard_before = heard_,
          .saw_it_come_up = saw_it_come_up_,
          .bus_offs = static_cast<std::uint32_t>(std::count_if(
              bus_offs_.begin(), bus_offs_.end(), [now](TimePoint at) { return is_within(at, now, kMinute); })),
          .excursions = is_within(excursions_.back(), now, kExcursionsWithin),
          .load_per_mille = statistics.load_per_mille,
          .bitrate = statistics.bitrate,
          .doubled = known.doubled,
          .busiest = full ? busiest() : std::string()};
}

std::string BusSurvey::busiest() const {
  std::vector<PeriodHealth> all = periods();
  std::erase_if(all, [now = Clock::now()](const PeriodHealth& one) { return !is_within(one.last, now, kMinute); });
  const auto most = std::ranges::min_element(all, {}, [](const PeriodHealth& one) { return one.period.p50; });
  if (most == all.end()) {
    return {};
  }
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "0x%03X, every %.1f ms", most->cob_id,
                std::chrono::duration<double, std::milli>(most->period.p50).count());
  return text.data();
}

BusHealth BusSurvey::health() const {
  return {.suspicion = suspicion(),
          .suspected_since = suspicion_.since(),
          .suspicion_age = Clock::now() - suspicion_.shown(),
          .load = load_.of_day(hour_),
          .transmit_errors = transmit_errors_.of_day(hour_),
          .receive_errors = receive_errors_.of_day(hour_),
          .errors = errors_.of_day(hour_),
          .burst = burst(),
          .nodes = nodes_.of_day(hour_)};
}

}  // namespace canopen
