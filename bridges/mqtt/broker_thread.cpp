#include "bridges/mqtt/broker_thread.h"

#include <pthread.h>

#include <algorithm>
#include <csignal>
#include <random>
#include <utility>

#include "bridges/mqtt/reasons.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;

constexpr int kMqtt5 = 5;
constexpr int kMqtt311 = 4;
// A connection that held this long was a good one.
constexpr auto kGoodConnection = 10s;
constexpr auto kGoodbye = 500ms;
// Nothing that was sent is acknowledged for this long: the broker hangs, although TCP stands. Paho's own ping does not
// notice while its socket is full.
constexpr auto kStall = 20s;
constexpr auto kStallCheck = 1s;
// alive(): longest time of the thread without a sign of life.
constexpr auto kSilence = 30s;
constexpr auto kForEver = 24h * 3650;
// So many closes instead of a CONNACK mean that the broker does not know MQTT 5.
constexpr int kCloses = 2;

// Signals are the daemon's main thread's; Paho's threads inherit this.
void block_signals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

std::string bracketed(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

std::string text_of(const Refusal& refusal) {
  if (refusal.code >= 0) {
    return "the broker refuses the connection: " + reason_text(refusal.code);
  }
  return refusal.closed ? "the connection is refused or closed before the broker answers" : "no connection";
}

}  // namespace

BrokerThread::BrokerThread(PublisherSettings settings, std::shared_ptr<LoopPost> loop)
    : settings_(std::move(settings)),
      broker_(bracketed(settings_.broker.host) + ":" + std::to_string(settings_.broker.port)),
      loop_(std::move(loop)),
      backoff_(settings_.first_pause, settings_.longest_pause, std::random_device{}()) {}

void BrokerThread::run() {
  block_signals();
  for (bool goes_on = true; goes_on;) {
    const auto begun = Clock::now();
    const End end = attempt();
    drop_client();
    if (Clock::now() - begun > kGoodConnection) {
      backoff_.reset();
      last_failure_.clear();
    }
    const auto duration = end.stays ? settings_.pause_after_refusal : backoff_.next();
    say_failure(end, duration);
    goes_on = pause(duration);
  }
  {
    const std::lock_guard lock(mutex_);
    expect_sign_of_life(kForEver);
  }
  loop_->post(Ended{});
  ended_.release();
}

BrokerThread::End BrokerThread::attempt() {
  const std::string address = next_address();
  if (address.empty()) {
    return {"the name " + settings_.broker.host + " has no address"};
  }
  const std::optional<Refusal> refusal = connect_by_any_version(address);
  if (refusal) {
    return {text_of(*refusal), refuses_credentials(refusal->code)};
  }
  addresses_.clear();  // the next connection asks anew
  say(Level::info, "MQTT: connected to " + broker_ + (version_ == kMqtt5 ? ", MQTT 5" : ", MQTT 3.1.1"));
  loop_->post(Connected{.id = connection_, .version = version_, .broker = broker_});
  return serve();
}

std::string BrokerThread::next_address() {
  if (next_address_ >= addresses_.size()) {
    {
      const std::lock_guard lock(mutex_);
      expect_sign_of_life(settings_.resolve_patience);
    }
    addresses_ = settings_.resolver(settings_.broker);
    next_address_ = 0;
    std::erase_if(closes_, [this](const auto& each) {
      return std::find(addresses_.begin(), addresses_.end(), each.first) == addresses_.end();
    });
  }
  return addresses_.empty() ? std::string() : addresses_[next_address_++];
}

std::optional<Refusal> BrokerThread::connect_by_any_version(const std::string& address) {
  if (settings_.version != 0) {
    return connect(address, settings_.version);
  }
  const std::optional<Refusal> refusal = connect(address, kMqtt5);
  if (!refusal || !refusal->closed) {
    closes_.erase(address);
  } else if (++closes_[address] < kCloses) {
    return refusal;
  }
  if (!refusal || (!refusal->closed && !refuses_version(refusal->code))) {
    return refusal;
  }
  drop_client();
  const std::optional<Refusal> older = connect(address, kMqtt311);
  if (older && older->closed) {
    closes_.erase(address);  // it closes whatever the version
  }
  return older;
}

std::optional<Refusal> BrokerThread::connect(const std::string& address, int version) {
  {
    const std::lock_guard lock(mutex_);
    if (finishing_) {
      return Refusal{};
    }
    expect_sign_of_life(kSilence);
    link_ = Link::connecting;
    refusal_ = {};
    down_code_ = -1;
    drop_.reset();
    suspects_takeover_ = false;
    stalled_ = false;
    ++connection_;
    watched_.clear();
  }
  version_ = version;
  ClientSettings settings = settings_.client;
  settings.uri = "tcp://" + bracketed(address) + ":" + std::to_string(settings_.broker.port);
  settings.version = version;
  client_ = std::make_unique<Client>(settings, static_cast<ClientEvents&>(*this));
  if (!client_->connect()) {
    return Refusal{};
  }
  Lock lock(mutex_);
  wake_.wait_for(lock, settings.connect_timeout + 2s, [this] { return link_ != Link::connecting || finishing_; });
  if (link_ != Link::up && link_ != Link::down) {
    return refusal_;
  }
  progress_ = Clock::now();
  return std::nullopt;
}

BrokerThread::End BrokerThread::serve() {
  Lock lock(mutex_);
  for (;;) {
    expect_sign_of_life(kSilence);
    wake_.wait_for(lock, kStallCheck, [this] { return has_work(); });
    stalled_ = !in_flight_.empty() && Clock::now() - progress_ > kStall;
    if (link_ != Link::up || stalled_) {
      return how_it_ended();
    }
    if (!carry_out(lock, std::exchange(orders_, {})) || !send(lock)) {
      link_ = Link::down;
    } else if (drop_) {
      lock.unlock();
      client_->disconnect(kGoodbye, true);
      lock.lock();
      return how_it_ended();
    } else if (finishing_ && farewell_over()) {
      const bool say_will = !has_last_words_ || !all_said();
      lock.unlock();
      client_->disconnect(kGoodbye, say_will);
      return {};
    }
  }
}

bool BrokerThread::carry_out(Lock& lock, std::vector<Order> orders) {
  std::erase_if(orders, [this](const Order& order) { return order.connection != connection_; });
  for (const Order& order : orders) {
    note_watched(order);
  }
  lock.unlock();
  const bool done = std::all_of(orders.begin(), orders.end(), [this](const Order& order) {
    return order.ends ? client_->unsubscribe(order.subscription.filter) : client_->subscribe(order.subscription);
  });
  lock.lock();
  return done;
}

bool BrokerThread::send(Lock& lock) {
  while (sends() && in_flight_.size() < limits_.window) {
    const auto now = Clock::now();
    std::optional<Outbox::Item> item = outbox_.pop(now);
    if (!item) {
      return true;
    }
    left_ = now;
    if (!fits(item->message)) {
      ++dropped_;
      continue;
    }
    progress_ = in_flight_.empty() ? now : progress_;
    const auto sent = in_flight_.insert(in_flight_.end(), std::move(*item));
    const Message* const message = &sent->message;
    lock.unlock();
    const Client::Sent outcome = client_->publish(*message);
    lock.lock();
    if (outcome == Client::Sent::unfit) {
      in_flight_.erase(sent);
      ++dropped_;
    } else if (outcome == Client::Sent::broken) {
      return false;
    }
  }
  return true;
}

void BrokerThread::drop_client() {
  client_.reset();  // without the lock: events may still come
  const std::lock_guard lock(mutex_);
  const bool stood = link_ == Link::up || link_ == Link::down;
  const std::string why = how_it_ended().why;
  link_ = Link::none;
  orders_.clear();
  if (!stood) {
    return;
  }
  outbox_.forget_retained();
  for (Outbox::Item& item : in_flight_) {
    if (item.message.kind == MessageKind::answer) {
      outbox_.put_back(std::move(item), Clock::now());
    }
  }
  in_flight_.clear();
  loop_->post(Disconnected{.why = why, .taken_over = is_takeover(down_code_)});
  if (outbox_.answers_dropped() != said_answers_) {
    said_answers_ = outbox_.answers_dropped();
    say(Level::warning, "MQTT: answers dropped because the broker was away, slow, or closed the connection: " +
                            std::to_string(said_answers_) + " since the start");
  }
}

bool BrokerThread::pause(std::chrono::milliseconds duration) {
  Lock lock(mutex_);
  expect_sign_of_life(duration + kSilence);
  return !wake_.wait_for(lock, duration, [this] { return finishing_; });
}

void BrokerThread::say_failure(const End& end, std::chrono::milliseconds pause) {
  const std::lock_guard lock(mutex_);
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

}  // namespace mqtt
