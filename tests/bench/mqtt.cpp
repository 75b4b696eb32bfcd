#include <fmt/format.h>
#include <mqtt/async_client.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <boost/asio/post.hpp>
#include <chrono>
#include <fstream>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/bench/parts.h"
#include "tests/bench/rates.h"
#include "tests/bench/site.h"

namespace bench {
namespace {

constexpr std::chrono::milliseconds kTime{1500};
constexpr std::size_t kKept = 2000;  ///< Messages of the gateway that the ceiling publishes again.

/// A mosquitto of our own on loopback.
class Broker {
 public:
  explicit Broker(std::uint16_t port) : port_(port), config_(fmt::format("/tmp/gateway-bench-{}.conf", getpid())) {
    std::ofstream(config_) << "listener " << port
                           << " 127.0.0.1\nallow_anonymous true\nmax_queued_messages 0\nlog_type none\n";
    process_ = fork();
    if (process_ == 0) {
      execlp("mosquitto", "mosquitto", "-c", config_.c_str(), nullptr);
      _exit(127);
    }
  }
  ~Broker() {
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
    unlink(config_.c_str());
  }
  Broker(const Broker&) = delete;
  Broker& operator=(const Broker&) = delete;

  [[nodiscard]] std::string uri() const { return fmt::format("tcp://127.0.0.1:{}", port_); }

 private:
  std::uint16_t port_;
  std::string config_;
  pid_t process_;
};

/// Counts what arrives, and keeps the first of it.
class Subscriber final : public virtual ::mqtt::callback {
 public:
  Subscriber(const std::string& uri, const std::string& filter) : client_(uri, "bench-subscriber-" + filter, nullptr) {
    client_.set_callback(*this);
    for (int tries = 0;; ++tries) {
      try {
        client_.connect()->wait();
        break;
      } catch (const ::mqtt::exception&) {
        if (tries == 50) {
          throw std::runtime_error("the broker does not answer; is mosquitto installed?");
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      }
    }
    client_.subscribe(filter, 1)->wait();
  }
  ~Subscriber() override { client_.disconnect()->wait(); }
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;

  void message_arrived(::mqtt::const_message_ptr message) override {
    ++count_;
    const std::lock_guard lock(mutex_);
    if (kept_.size() < kKept) {
      kept_.push_back(std::move(message));
    }
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::vector<::mqtt::const_message_ptr> kept() {
    const std::lock_guard lock(mutex_);
    return kept_;
  }

  /// Messages per second over kTime, after a moment to get going.
  [[nodiscard]] double rate() const {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const std::uint64_t before = count_;
    const double passed = seconds_of([] { std::this_thread::sleep_for(kTime); });
    return static_cast<double>(count_ - before) / passed;
  }

 private:
  ::mqtt::async_client client_;
  std::atomic<std::uint64_t> count_{0};
  std::mutex mutex_;
  std::vector<::mqtt::const_message_ptr> kept_;
};

/// Publishes the given messages again and again, as fast as Paho takes them.
double bare_rate(const std::string& uri, const std::vector<::mqtt::const_message_ptr>& messages) {
  Subscriber subscriber(uri, "bare/#");
  ::mqtt::async_client client(uri, "bench-bare", nullptr);
  ::mqtt::connect_options options;
  options.set_max_inflight(1000);
  client.connect(options)->wait();
  std::atomic<bool> stop{false};
  std::thread publisher([&] {
    std::size_t next = 0;
    while (!stop) {
      const ::mqtt::const_message_ptr& original = messages[next++ % messages.size()];
      try {
        client.publish("bare/" + original->get_topic(), original->get_payload_ref().data(),
                       original->get_payload_ref().size(), 1, true);
      } catch (const ::mqtt::exception&) {
        // Its window is full: let it work.
        std::this_thread::sleep_for(std::chrono::microseconds(200));
      }
    }
  });
  const double rate = subscriber.rate();
  stop = true;
  publisher.join();
  client.disconnect(std::chrono::seconds(5))->wait();
  return rate;
}

/// Keeps a drive's TPDO1 changing faster than anything could publish it.
class Changes {
 public:
  explicit Changes(SiteInThread& site) : site_(site) {
    site_.on_loop([this] {
      link_ = site_.bus().connect();
      step();
    });
  }
  ~Changes() {
    site_.on_loop([this] {
      stop_ = true;
      link_.reset();
    });
    site_.on_loop([] {});
  }
  Changes(const Changes&) = delete;
  Changes& operator=(const Changes&) = delete;

 private:
  void step() {
    if (stop_) {
      return;
    }
    ++counter_;
    canopen::Frame frame;
    frame.id = 0x185;
    frame.size = 8;
    for (std::size_t i = 2; i < 8; i += 2) {
      frame.data[i] = static_cast<std::uint8_t>(counter_);
      frame.data[i + 1] = static_cast<std::uint8_t>(counter_ >> 8U & 0x0FU);
    }
    static_cast<void>(link_->send(frame));
    boost::asio::post(site_.loop(), [this] { step(); });
  }

  SiteInThread& site_;
  std::unique_ptr<canopen::Link> link_;
  bool stop_ = false;
  unsigned counter_ = 0;
};

}  // namespace

void mqtt() {
  const std::uint16_t port = free_port();
  const Broker broker(port);
  Subscriber gateway_messages(broker.uri(), "canopen/demo/pump1/#");
  SiteInThread site(demo_model(0, port));
  if (!site.wait_online()) {
    throw std::runtime_error("the simulated drives did not come online");
  }
  const auto gateway = [&] {
    const Changes changes(site);
    return gateway_messages.rate();
  };
  // Once, for the messages that the ceiling is measured with.
  static_cast<void>(gateway());
  const std::vector<::mqtt::const_message_ptr> messages = gateway_messages.kept();
  if (messages.size() < kKept) {
    throw std::runtime_error("the gateway published too little to measure");
  }
  print(compare(
      "MQTT, QoS 1, every change published", "messages/s", 5, [&] { return bare_rate(broker.uri(), messages); },
      gateway));
}

}  // namespace bench
