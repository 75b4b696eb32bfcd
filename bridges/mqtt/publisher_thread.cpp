// What the publisher's thread does: attempt, serve the connection, pause.

#include <pthread.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <future>
#include <system_error>
#include <utility>

#include "bridges/mqtt/publisher.h"
#include "bridges/mqtt/reasons.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;

// A connection that held this long was a good one.
constexpr auto kGoodConnection = 10s;
constexpr auto kGoodbye = 500ms;
constexpr auto kStallCheck = 1s;
constexpr auto kEndCheck = 50ms;
// After the farewell; both together are shorter than kStopLimit.
constexpr auto kLetGo = 1s;
constexpr auto kForEver = 24h * 3650;
// After an attempt that took as long as connect_timeout: the cause is told within 10 s.
constexpr auto kTlsPatience = 3s;

// Signals are the daemon's main thread's; Paho's threads inherit this.
void block_signals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

// Nothing: it cannot be read, or is empty.
std::optional<std::string> first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  line.resize(std::min(line.find('\r'), line.size()));
  return line.empty() ? std::nullopt : std::optional(std::move(line));
}

}  // namespace

void Publisher::run() {
  block_signals();
  for (bool goes_on = true; goes_on;) {
    const Line::End end = attempt();
    drop_client();
    const auto duration = end.stays ? settings_.pause_after_refusal : attempts_.next_pause();
    say_failure(end, duration);
    goes_on = pause(duration);
  }
  {
    const Guard lock(mutex_);
    expect_sign_of_life(kForEver);
  }
  loop_->post([this] {
    ended_ = true;
    ended_timer_.cancel();
  });
}

Line::End Publisher::attempt() {
  if (attempts_.wants_addresses()) {
    resolved_ = addresses();
    // With TLS Paho gets the name, which the certificate must be for, and takes the address that the system gives.
    const bool named = settings_.broker.tls && !resolved_.empty();
    attempts_.found(named ? std::vector<std::string>{settings_.broker.host} : resolved_);
  }
  const std::string address = attempts_.next_address();
  if (address.empty()) {
    return {"the name " + settings_.broker.host + " has no address"};
  }
  for (std::optional<int> version = attempts_.first_version(); version;) {
    const std::optional<Refusal> refusal = connect(address, *version);
    if (!refusal) {
      say(Level::info, "MQTT: connected to " + broker_ + (*version == 5 ? ", MQTT 5" : ", MQTT 3.1.1") +
                           (settings_.broker.tls ? ", TLS" : ""));
      loop_->post([this, connected = Connected{.id = line_.connection, .version = *version, .broker = broker_}] {
        events_->on_connected(connected);
      });
    }
    version = attempts_.next_version(address, *version, refusal);
    if (!refusal) {
      const auto begun = Clock::now();
      Line::End end = serve();
      if (Clock::now() - begun > kGoodConnection) {
        attempts_.held();
        last_failure_.clear();
      }
      return end;
    }
    if (!version && !refusal->why.empty()) {
      const TlsFiles& tls = settings_.client.tls;
      const std::string told = without_paths(refusal->why, {settings_.password_file, tls.ca, tls.cert, tls.key});
      loop_->post([this, why = told] { events_->on_no_connection(why); });
    }
    if (!version) {
      return {text_of(*refusal), refuses_credentials(refusal->code)};
    }
    drop_client();
  }
  return {};
}

// In a thread of its own, which owns all it uses: one that hangs is left to itself.
std::vector<std::string> Publisher::addresses() {
  {
    const Guard lock(mutex_);
    expect_sign_of_life(settings_.resolve_patience);
  }
  std::packaged_task<std::vector<std::string>()> task(
      [resolver = settings_.resolver, broker = settings_.broker] { return resolver(broker); });
  auto found = task.get_future();
  try {
    std::thread(std::move(task)).detach();
  } catch (const std::system_error&) {
    return {};  // none is to be had: tried again
  }
  while (found.wait_for(kEndCheck) != std::future_status::ready) {
    const Guard lock(mutex_);
    if (finishing_) {
      return {};
    }
  }
  return found.get();
}

std::optional<Refusal> Publisher::connect(const std::string& address, int version) {
  {
    const Guard lock(mutex_);
    if (finishing_) {
      return Refusal{};
    }
    // Paho may look up a name itself, and holds up whatever else is asked of it then.
    expect_sign_of_life(settings_.broker.tls ? settings_.resolve_patience : settings_.silence);
    line_.begin();
  }
  ClientSettings settings = settings_.client;
  if (!settings_.password_file.empty()) {
    std::optional<std::string> password = first_line(settings_.password_file);
    if (!password) {
      return Refusal{.why = "password_file " + settings_.password_file +
                            " cannot be read, or begins with an empty line; give it a first line, readable for the "
                            "gateway's user"};
    }
    settings.password = std::move(*password);
  }
  std::string mistake = settings_.broker.tls ? tls_files_mistake(settings.tls) : std::string();
  if (!mistake.empty()) {
    return Refusal{.why = std::move(mistake)};
  }
  settings.uri =
      (settings_.broker.tls ? "ssl://" : "tcp://") + uri_host(address) + ":" + std::to_string(settings_.broker.port);
  settings.version = version;
  gate_ = std::make_unique<EventGate>(static_cast<ClientEvents&>(*this));
  client_ = std::make_unique<Client>(settings, *gate_);
  if (!client_->connect()) {
    return Refusal{};
  }
  std::optional<Refusal> refusal = await_connection(settings.connect_timeout + 2s, version);
  if (refusal && refusal->code < 0 && settings_.broker.tls) {
    if (std::string why = mistake_of_tls(); !why.empty()) {
      return Refusal{.why = std::move(why)};
    }
  }
  return refusal;
}

std::optional<Refusal> Publisher::await_connection(std::chrono::milliseconds patience, int version) {
  Lock lock(mutex_);
  wake_.wait_for(lock, patience, [this] { return line_.state != Line::State::connecting || finishing_; });
  if (!line_.stood()) {
    return line_.refusal;
  }
  traffic_.begin(line_.limits, version, Clock::now());
  return std::nullopt;
}

std::string Publisher::mistake_of_tls() {
  {
    const Guard lock(mutex_);
    if (finishing_) {
      return {};
    }
  }
  return tls_mistake(settings_.broker, resolved_, settings_.client.tls, kTlsPatience);
}

Line::End Publisher::serve() {
  Lock lock(mutex_);
  for (;;) {
    if (!traffic_.may_send(Clock::now())) {
      expect_sign_of_life(settings_.silence);  // what could leave and does not is no sign of life; send() gives it
    }
    wake_.wait_for(lock, kStallCheck, [this] { return has_work(); });
    line_.stalled = traffic_.stalled(Clock::now());
    if (!line_.is_up() || line_.stalled) {
      return line_.end(settings_.client.client_id);
    }
    if (!carry_out(lock) || !send(lock)) {
      line_.state = Line::State::down;
    } else if (line_.drop || (finishing_ && farewell_over())) {
      const bool say_will = line_.drop || !has_last_words_ || !traffic_.nothing_waits();
      lock.unlock();
      client_->disconnect(kGoodbye, say_will);
      lock.lock();
      return line_.end(settings_.client.client_id);
    }
  }
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
  while (const Message* const message = line_.wants() ? nullptr : traffic_.next(Clock::now())) {
    expect_sign_of_life(settings_.silence);
    lock.unlock();
    const Client::Sent outcome = client_->publish(*message);
    lock.lock();
    if (outcome == Client::Sent::unfit) {
      traffic_.unfit(message);
    } else if (outcome == Client::Sent::broken) {
      traffic_.not_sent(message, Clock::now());
      return false;
    }
  }
  return true;
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
    loop_->post([this, why = end.why, taken_over = is_takeover(line_.down_code)] {
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

void Publisher::say_failure(const Line::End& end, std::chrono::milliseconds pause) {
  const Guard lock(mutex_);
  if (finishing_ || end.why == last_failure_) {
    return;  // said once is enough for as long as it lasts
  }
  last_failure_ = end.why;
  std::string text = "MQTT: " + broker_ + ": " + end.why + "; trying again";
  if (end.stays) {
    text += " in " + std::to_string(std::chrono::ceil<std::chrono::seconds>(pause).count()) + " s";
  }
  say(end.stays ? Level::error : Level::warning, std::move(text));
}

bool Publisher::farewell_over() {
  return !traffic_.is_open() || traffic_.all_said(Clock::now()) || Clock::now() >= finish_by_;
}

bool Publisher::has_work() {
  return line_.wants() || traffic_.may_send(Clock::now()) || (finishing_ && farewell_over());
}

// Without the lock: the thread would wait for it at once. Most acknowledgements change nothing for it.
void Publisher::wake_if_needed(Lock lock) {
  const bool needed = has_work();
  lock.unlock();
  if (needed) {
    wake_.notify_one();
  }
}

}  // namespace mqtt
