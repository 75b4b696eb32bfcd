// Does memory stay flat where connections break again and again with messages under way and waiting?
//
//   mqtt_reconnects [CONNECTIONS [BYTES]]    2 000, messages of 1 000 bytes; prints the resident memory on the way and
//                                            fails where it grew by more than 2 MB after the first tenth. The broker,
//                                            which closes in mid-publish, is a process of its own.

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "bridges/mqtt/publisher.h"
#include "tests/unit/mqtt/tiny_broker.h"

namespace {

using namespace std::chrono_literals;

constexpr int kMessages = 100;
constexpr long kMayGrow = 2048;  // kB

long resident_kb() {
  std::ifstream file("/proc/self/statm");
  long size = 0;
  long resident = 0;
  file >> size >> resident;
  return resident * (sysconf(_SC_PAGESIZE) / 1024);
}

/// Announces, as the bridge does, with each connection.
class Announcer final : public mqtt::BrokerEvents {
 public:
  void on_connected(const mqtt::Connected& connection) override {
    publisher->subscribe(connection.id, {{"x/+/set", 1}, {"x/+/+/set", 1}, {"x/alarm", 1, true}});
    publisher->open(connection.id);
    std::vector<mqtt::Message> batch;
    for (int i = 0; i < kMessages; ++i) {
      batch.push_back({.topic = "t/" + std::to_string(i), .payload = std::string(size, 'x'), .expiry = 60});
    }
    batch.push_back({.topic = "answers/1",
                     .payload = "ok",
                     .kind = mqtt::MessageKind::answer,
                     .retained = false,
                     .correlation = std::string(size, 'c')});
    publisher->publish(std::move(batch));
  }
  void on_disconnected(const std::string& /*why*/) override { ++broken; }
  void on_subscribed(const mqtt::Subscribed& /*subscribed*/) override {}
  void on_unsubscribed(const std::string& /*filter*/) override {}
  void on_message(mqtt::Incoming /*message*/) override {}
  [[nodiscard]] bool is_stop(const mqtt::Incoming& /*message*/) const override { return false; }

  mqtt::Publisher* publisher = nullptr;
  std::size_t size = 1000;
  int broken = 0;
};

int run(std::uint16_t port, int connections, std::size_t size) {
  boost::asio::io_context context{1};
  const auto work = boost::asio::make_work_guard(context);
  config::Mqtt site;
  site.brokers = {{"127.0.0.1", port}};
  mqtt::PublisherSettings settings = mqtt::publisher_settings(site, {"flap"});
  settings.first_pause = 1ms;
  settings.longest_pause = 2ms;
  Announcer events;
  mqtt::Publisher publisher(context.get_executor(), std::move(settings), [](mqtt::Level, const std::string&) {});
  events.publisher = &publisher;
  events.size = size;
  publisher.start(events);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const auto end = std::chrono::steady_clock::now() + 600s;
  long after_first = 0;
  for (int next = connections / 10; events.broken < connections && std::chrono::steady_clock::now() < end;) {
    context.run_one_for(100ms);
    if (events.broken >= next) {
      const long now = resident_kb();
      after_first = after_first == 0 ? now : after_first;
      std::printf("%d connections: %ld kB\n", events.broken, now);
      next += connections / 10;
    }
  }
  const long grown = resident_kb() - after_first;
  std::printf("grown by %ld kB since the first tenth; at most %ld\n", grown, kMayGrow);
  return events.broken >= connections && grown <= kMayGrow ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  int port_pipe[2];
  if (pipe(port_pipe) != 0) {
    return 2;
  }
  const pid_t broker = fork();
  if (broker == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    mqtt::test::TinyBroker serves({.speaks_5 = true, .patience = kMessages * 4 / 5});
    const std::uint16_t port = serves.port();
    if (write(port_pipe[1], &port, sizeof(port)) == sizeof(port)) {
      pause();
    }
    return 2;
  }
  std::uint16_t port = 0;
  if (broker < 0 || read(port_pipe[0], &port, sizeof(port)) != sizeof(port)) {
    return 2;
  }
  constexpr int kConnections = 2000;
  constexpr std::size_t kBytes = 1000;
  const int outcome = run(port, argc > 1 ? std::atoi(argv[1]) : kConnections,
                          argc > 2 ? static_cast<std::size_t>(std::atoi(argv[2])) : kBytes);
  kill(broker, SIGKILL);
  waitpid(broker, nullptr, 0);
  return outcome;
}
