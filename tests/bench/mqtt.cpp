#include <fmt/format.h>

#include <boost/asio/post.hpp>
#include <chrono>
#include <stdexcept>
#include <vector>

#include "tests/bench/broker.h"
#include "tests/bench/paho_clients.h"
#include "tests/bench/parts.h"
#include "tests/bench/rates.h"
#include "tests/bench/site.h"

namespace bench {
namespace {

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
  gateway_messages.wait_for_first();
  const auto gateway = [&] {
    const Changes changes(site);
    return gateway_messages.rate();
  };
  // Once, for the messages that the ceiling is measured with.
  static_cast<void>(gateway());
  const std::vector<Published> messages = gateway_messages.kept();
  if (messages.size() < Subscriber::kKept) {
    throw std::runtime_error(fmt::format("the gateway published too little to measure: {} messages", messages.size()));
  }
  print(compare(
      "MQTT, QoS 1, every change published", "messages/s", 5, [&] { return bare_rate(broker.uri(), messages); },
      gateway));
}

}  // namespace bench
