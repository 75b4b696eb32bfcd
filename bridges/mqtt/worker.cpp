#include "bridges/mqtt/worker.h"

#include <pthread.h>

#include <csignal>
#include <random>
#include <thread>
#include <utility>

#include "bridges/mqtt/backoff.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;

// CONNACK of a broker that does not speak MQTT 5: "unacceptable protocol version" of 3.1.1 (§3.2.2.3), or of 5
// (§3.2.2.2).
constexpr int kRefusedVersion3 = 1;
constexpr int kRefusedVersion5 = 0x84;
constexpr int kMqtt5 = 5;
constexpr int kMqtt311 = 4;

// A connection that held this long was a good one.
constexpr auto kGoodConnection = 10s;
constexpr auto kGoodbye = 500ms;
// For Paho's threads to be done with a client after they left our callbacks: it must not vanish under them.
constexpr auto kGrace = 20ms;

// Signals are the daemon's main thread's; Paho's threads inherit this.
void block_signals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

std::string bracketed(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

// CONNACK codes of MQTT 3.1.1 and 5.
std::string refusal_text(int code) {
  switch (code) {
    case 2:
    case 0x85:
      return "the broker refuses the client id";
    case 3:
    case 0x88:
      return "the broker is not available";
    case 4:
    case 0x86:
      return "the broker refuses user name or password";
    case 5:
    case 0x87:
      return "the broker does not authorize the gateway";
    default:
      break;
  }
  return code < 0 ? "no connection" : "the broker refuses the connection with code " + std::to_string(code);
}

}  // namespace

Worker::Worker(PublisherSettings settings, std::shared_ptr<LoopPost> loop)
    : settings_(std::move(settings)), loop_(std::move(loop)), traffic_(settings_.outbox, loop_) {}

void Worker::run() {
  block_signals();
  Backoff backoff(settings_.first_pause, settings_.longest_pause, std::random_device{}());
  for (;;) {
    const auto begun = std::chrono::steady_clock::now();
    const std::string why = attempt();
    if (traffic_.finishing()) {
      break;
    }
    say_failure(why);
    if (std::chrono::steady_clock::now() - begun > kGoodConnection) {
      backoff.reset();
    }
    if (!traffic_.pause(backoff.next())) {
      break;
    }
    drop_connection();
  }
  drop_connection();
  loop_->post(Ended{});
  ended_.release();
}

std::string Worker::attempt() {
  const std::string address = next_address();
  if (address.empty()) {
    return "the name " + settings_.broker.host + " has no address";
  }
  int version = kMqtt5;
  std::optional<int> refusal = connect(address, version);
  if (refusal == kRefusedVersion3 || refusal == kRefusedVersion5) {
    drop_connection();
    version = kMqtt311;
    refusal = connect(address, version);
  }
  if (refusal) {
    return refusal_text(*refusal);
  }
  addresses_.clear();  // the next connection asks anew
  last_failure_.clear();
  say(Level::info, "MQTT: connected to " + bracketed(settings_.broker.host) + ":" +
                       std::to_string(settings_.broker.port) + (version == kMqtt5 ? ", MQTT 5" : ", MQTT 3.1.1"));
  loop_->post(Connected{.id = current_,
                        .version = version,
                        .broker = bracketed(settings_.broker.host) + ":" + std::to_string(settings_.broker.port)});
  std::string why = serve();
  loop_->post(Disconnected{why});
  return why;
}

std::string Worker::next_address() {
  if (next_address_ >= addresses_.size()) {
    addresses_ = settings_.resolver(settings_.broker);
    next_address_ = 0;
  }
  return addresses_.empty() ? std::string() : addresses_[next_address_++];
}

std::optional<int> Worker::connect(const std::string& address, int version) {
  const auto begun = traffic_.begin();
  if (!begun) {
    return -1;
  }
  current_ = *begun;
  ConnectionSettings settings = settings_.connection;
  settings.uri = "tcp://" + bracketed(address) + ":" + std::to_string(settings_.broker.port);
  settings.version = version;
  connection_ = std::make_unique<Connection>(settings, traffic_);
  if (!connection_->connect()) {
    return -1;
  }
  return traffic_.await_connection(settings.connect_timeout + 2s);
}

std::string Worker::serve() {
  for (;;) {
    Traffic::Work work = traffic_.await_work();
    if (work.over) {
      return *work.over;
    }
    if (!send(work)) {
      traffic_.broken();
      continue;
    }
    if (work.farewell) {
      connection_->disconnect(kGoodbye, !work.all_said);
      return {};
    }
  }
}

bool Worker::send(Traffic::Work& work) {
  for (const std::vector<Subscription>& subscriptions : work.subscriptions) {
    if (!connection_->subscribe(subscriptions)) {
      return false;
    }
  }
  for (const std::string& filter : work.unsubscriptions) {
    if (!connection_->unsubscribe(filter)) {
      return false;
    }
  }
  bool whole = true;
  for (auto& [message, in_flight] : work.messages) {
    if (!whole) {
      // Not handed over any more; an answer is not to be lost with the rest.
      if (message.kind == MessageKind::answer) {
        in_flight->answer = std::move(message);
      }
      continue;
    }
    const Connection::Sent sent = connection_->publish(std::move(message), *in_flight);
    whole = sent != Connection::Sent::broken;
    if (sent == Connection::Sent::unfit) {
      traffic_.unfit(in_flight);
    }
  }
  return whole;
}

void Worker::drop_connection() {
  if (connection_) {
    std::this_thread::sleep_for(kGrace);
    connection_.reset();
  }
  traffic_.end();
}

void Worker::say(Level level, std::string text) {
  loop_->post(Said{level, std::move(text)});
}

void Worker::say_failure(const std::string& why) {
  if (why == last_failure_) {
    return;  // said once is enough for as long as it lasts
  }
  last_failure_ = why;
  say(Level::warning, "MQTT: " + bracketed(settings_.broker.host) + ":" + std::to_string(settings_.broker.port) + ": " +
                          why + "; trying again");
}

}  // namespace mqtt
