// What the publisher's thread does: give each broker its turn, serve the connection, pause.

#include <pthread.h>

#include <algorithm>
#include <csignal>
#include <future>
#include <utility>

#include "bridges/mqtt/publisher.h"
#include "bridges/mqtt/reasons.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;

// A connection that held this long was a good one.
constexpr auto kGoodConnection = 10s;
constexpr auto kGoodbye = 500ms;
constexpr auto kShortGoodbye = 200ms;
constexpr auto kStallCheck = 1000ms;
constexpr auto kLookCheck = 500ms;
constexpr auto kEndCheck = 50ms;
// After the farewell; both together are shorter than kStopLimit.
constexpr auto kLetGo = 1s;
constexpr auto kForEver = 24h * 3650;

// Signals are the daemon's main thread's; Paho's threads inherit this.
void block_signals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

}  // namespace

void Publisher::run() {
  block_signals();
  for (bool goes_on = true; goes_on;) {
    const Turn turn = take_turn();
    drop_client();
    Candidate& ended = candidate();
    const auto duration = turn_to_next(turn);
    say_end(ended, turn, duration);
    goes_on = pause(duration);
  }
  {
    const Guard lock(mutex_);
    expect_sign_of_life(kForEver);
    thread_ends_ = true;
  }
  loop_->post([this] {
    ended_ = true;
    ended_timer_.cancel();
  });
}

std::chrono::milliseconds Publisher::turn_to_next(const Turn& turn) {
  using Outcome = Rotation::Outcome;
  const auto now = Clock::now();
  Outcome outcome = turn.end.stays ? Outcome::refused : Outcome::none;
  if (turn.stood) {
    const bool silent = turn.end.silent || (turn.end.dropped && turn.held);
    outcome = turn.held ? Outcome::broke : Outcome::brief;
    outcome = silent ? Outcome::silent : outcome;
    outcome = turn.end.stays ? Outcome::taken_over : outcome;
    outcome = turn.end.left ? Outcome::left : outcome;
  }
  if (turn.stood && outcome != Outcome::silent) {
    candidate().attempts.restart();
  }
  if (!turn.stood) {
    candidate().wordless_breaks = 0;  // it is away, so that is what its connections break at
  }
  if (outcome == Outcome::left) {
    homecoming_.went();
    candidates_.front().said.clear();  // why it does not give one this time is news
  }
  const bool at_first = rotation_.at() == 0;
  const auto duration = rotation_.next(outcome, now);
  if (at_first) {
    homecoming_.ended(turn.stood_for, rotation_.at() == 0, now);
  }
  return duration;
}

Publisher::Turn Publisher::serve() {
  const auto begun = Clock::now();
  look_.forget();  // it was begun in an earlier turn
  Turn turn{.end = serve_until_end(), .stood = true};
  const auto stood = Clock::now() - begun;
  turn.stood_for = std::chrono::duration_cast<std::chrono::milliseconds>(stood);
  turn.held = stood > kGoodConnection;
  {
    const Guard lock(mutex_);
    // Who was suspected a while ago is not why it broke now.
    turn.end.stays =
        turn.end.stays && (is_takeover(line_.down_code) || turn.stood_for <= 2 * settings_.pause_after_refusal);
    const bool wordless = turn.end.unexplained && line_.down_code < 0 && !turn.held;
    candidate().wordless_breaks = wordless ? candidate().wordless_breaks + 1 : 0;
  }
  if (candidate().wordless_breaks > 1) {  // as brokers do that do not tell of a take-over, mosquitto among them
    turn.end.why +=
        " soon after it came about, again; perhaps another client has the client id " + settings_.client.client_id;
  }
  if (turn.held) {
    candidate().said.clear();
  }
  return turn;
}

Line::End Publisher::serve_until_end() {
  Lock lock(mutex_);
  for (;;) {
    const auto now = wait_for_work(lock);
    line_.stalled = is_silent(now);
    if (!line_.is_up() || line_.stalled) {
      if (line_.stalled && has_elsewhere()) {
        // What lies in its socket is what it reads when it goes on, Paho's goodbye among it, behind which it says no
        // will. So that is said before: nobody comes back there soon.
        lock.unlock();
        client_->disconnect(kShortGoodbye, true);
        lock.lock();
      }
      return line_.end(settings_.client.client_id);
    }
    look_home(now);
    find_addresses_ahead(now);
    if (!carry_out(lock) || !send(lock)) {
      line_.state = Line::State::down;
    } else if (line_.drop || farewell_over(Clock::now())) {
      const bool say_will = line_.drop || (finishing_ && !has_last_words_) || !traffic_.nothing_waits();
      lock.unlock();
      client_->disconnect(kGoodbye, say_will);
      lock.lock();
      return line_.end(settings_.client.client_id);
    }
  }
}

Publisher::Clock::time_point Publisher::wait_for_work(Lock& lock) {
  auto now = Clock::now();
  if (!traffic_.may_send(now)) {
    expect_sign_of_life(settings_.silence, now);  // what could leave and does not is no sign of life; send() gives it
  }
  const auto due = check_at(now);
  while (!has_work(now) && now < due) {
    wake_.wait_until(lock, due);
    now = Clock::now();
  }
  return now;
}

bool Publisher::is_silent(Clock::time_point now) {
  if (!has_elsewhere()) {
    return traffic_.stalled(now);
  }
  // With QoS 0 nobody knows how much lies before the question on a slow line.
  if (settings_.client.qos > 0 && traffic_.is_idle() && pulse_.wants(now)) {
    line_.orders.push_back({.subscription = {.filter = settings_.pulse_filter}, .ends = true});
    pulse_.asked(now);
  }
  return traffic_.stalled(now, settings_.stalled) || pulse_.stopped(settings_.stalled, now);
}

Publisher::Clock::time_point Publisher::check_at(Clock::time_point now) {
  Clock::time_point due = now + (rotation_.at() == 0 ? kStallCheck : std::chrono::milliseconds(kLookCheck));
  if (has_elsewhere()) {
    due = std::min(due, traffic_.stalled_at(settings_.stalled));
    if (pulse_.is_asked() || (settings_.client.qos > 0 && traffic_.is_idle())) {
      due = std::min(due, pulse_.due(settings_.stalled));
    }
  }
  return std::max(due, now + 1ms);
}

bool Publisher::carry_out(Lock& lock) {
  const std::vector<Line::Order> orders = line_.take_orders();
  lock.unlock();
  const bool done = std::all_of(orders.begin(), orders.end(), [this](const Line::Order& order) {
    return order.ends ? client_->unsubscribe(order.subscription.filter) : client_->subscribe(order.subscription);
  });
  lock.lock();
  return done;
}

bool Publisher::send(Lock& lock) {
  // As much as there is may come faster than it leaves: other work does not wait for that.
  for (auto now = Clock::now();; now = Clock::now()) {
    const Message* const message = line_.wants() ? nullptr : traffic_.next(now);
    if (message == nullptr) {
      return true;
    }
    expect_sign_of_life(settings_.silence, now);
    lock.unlock();
    const Client::Sent outcome = client_->publish(*message);
    lock.lock();
    if (outcome == Client::Sent::unfit) {
      traffic_.unfit(message);
    } else if (outcome == Client::Sent::broken) {
      traffic_.not_sent(message, now);
      return false;
    }
  }
}

void Publisher::drop_client() {
  if (client_) {
    const std::future<void> gone = let_go(std::move(client_), std::move(gate_));
    for (bool waits = true; waits && gone.wait_for(kEndCheck) != std::future_status::ready;) {
      const Guard lock(mutex_);
      waits = !finishing_ || Clock::now() < finish_by_ + kLetGo;  // at the end one that hangs is left behind
    }
  }
  const Guard lock(mutex_);
  if (line_.stood()) {
    const Line::End end = line_.end(settings_.client.client_id);
    traffic_.end(end.unexplained, Clock::now());
    loop_->post([this, why = named(candidate(), end.why), taken_over = is_takeover(line_.down_code)] {
      if (taken_over) {
        events_->on_taken_over();
      }
      events_->on_disconnected(why);
    });
  }
  line_.state = Line::State::none;
  line_.orders.clear();
}

bool Publisher::pause(std::chrono::milliseconds duration) {
  Lock lock(mutex_);
  expect_sign_of_life(duration + settings_.silence);
  return !wake_.wait_for(lock, duration, [this] { return finishing_; });
}

std::string Publisher::named(const Candidate& which, const std::string& why) const {
  return is_one_of_several() ? which.name + ": " + why : why;
}

void Publisher::say_end(Candidate& ended, const Turn& turn, std::chrono::milliseconds pause) {
  if (is_finishing()) {
    return;
  }
  if (!turn.stood && (turn.to_mend || is_one_of_several())) {
    const TlsFiles& tls = settings_.client.tls;
    const std::string why = without_paths(turn.end.why, {settings_.password_file, tls.ca, tls.cert, tls.key});
    loop_->post([this, told = named(ended, why)] { events_->on_no_connection(told); });
  }
  if (turn.end.why == ended.said) {
    return;  // said once is enough for as long as it lasts
  }
  ended.said = turn.end.why;
  const Candidate& next = candidate();
  std::string text =
      "MQTT: " + ended.name + ": " + turn.end.why + "; trying " + (&next == &ended ? "again" : next.name);
  if (turn.end.stays && &next == &ended) {
    text += " in " + std::to_string(std::chrono::ceil<std::chrono::seconds>(pause).count()) + " s";
  }
  const Level level = turn.end.left ? Level::info : Level::warning;
  say(turn.end.stays ? Level::error : level, std::move(text));
}

bool Publisher::farewell_over(Clock::time_point now) {
  if (!finishing_ && !line_.leave_by) {
    return false;
  }
  const auto end = finishing_ ? finish_by_ : *line_.leave_by;
  return !traffic_.is_open() || traffic_.all_said(now) || now >= end;
}

bool Publisher::has_work(Clock::time_point now) {
  return line_.wants() || traffic_.may_send(now) || farewell_over(now);
}

// Without the lock: the thread would wait for it at once. Most acknowledgements change nothing for it.
void Publisher::wake_if_needed(Lock lock, Clock::time_point now) {
  const bool needed = has_work(now);
  lock.unlock();
  if (needed) {
    wake_.notify_one();
  }
}

}  // namespace mqtt
