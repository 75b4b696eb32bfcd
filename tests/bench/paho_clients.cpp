#include "tests/bench/paho_clients.h"

#include <mqtt/async_client.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include "tests/bench/rates.h"

namespace bench {
namespace {

constexpr std::chrono::milliseconds kTime{1500};

}  // namespace

class Subscriber::Body final : public virtual mqtt::callback {
 public:
  Body(const std::string& uri, const std::string& filter, Handler handler)
      : client_(uri, "bench-subscriber-" + filter, nullptr), handler_(std::move(handler)) {
    client_.set_callback(*this);
    for (int tries = 0;; ++tries) {
      try {
        client_.connect()->wait();
        break;
      } catch (const mqtt::exception&) {
        if (tries == 50) {
          throw std::runtime_error("the broker does not answer; is mosquitto installed?");
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      }
    }
    client_.subscribe(filter, 1)->wait();
  }
  ~Body() override { client_.disconnect()->wait(); }
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;

  void message_arrived(mqtt::const_message_ptr message) override {
    ++count_;
    if (handler_) {
      handler_(message->get_payload_str());
    }
    const std::lock_guard lock(mutex_);
    if (kept_.size() < kKept) {
      kept_.push_back({message->get_topic(), message->get_payload_str()});
    }
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::vector<Published> kept() {
    const std::lock_guard lock(mutex_);
    return kept_;
  }

 private:
  mqtt::async_client client_;
  Handler handler_;
  std::atomic<std::uint64_t> count_{0};
  std::mutex mutex_;
  std::vector<Published> kept_;
};

Subscriber::Subscriber(const std::string& uri, const std::string& filter, Handler handler)
    : body_(std::make_unique<Body>(uri, filter, std::move(handler))) {}

Subscriber::~Subscriber() = default;

void Subscriber::wait_for_first() const {
  for (int tries = 0; body_->count() == 0; ++tries) {
    if (tries == 200) {
      throw std::runtime_error("the gateway publishes nothing");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

std::vector<Published> Subscriber::kept() const {
  return body_->kept();
}

double Subscriber::rate() const {
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const std::uint64_t before = body_->count();
  const double passed = seconds_of([] { std::this_thread::sleep_for(kTime); });
  return static_cast<double>(body_->count() - before) / passed;
}

double bare_rate(const std::string& uri, const std::vector<Published>& messages) {
  const Subscriber subscriber(uri, "bare/#");
  mqtt::async_client client(uri, "bench-bare", nullptr);
  mqtt::connect_options options;
  options.set_max_inflight(1000);
  client.connect(options)->wait();
  std::atomic<bool> stop{false};
  std::thread publisher([&] {
    std::size_t next = 0;
    while (!stop) {
      const Published& message = messages[next++ % messages.size()];
      try {
        client.publish("bare/" + message.topic, message.payload.data(), message.payload.size(), 1, true);
      } catch (const mqtt::exception&) {
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

}  // namespace bench
