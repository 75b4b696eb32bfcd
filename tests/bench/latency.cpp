// How long a value is under way, from its frame on the in-process bus to a subscriber of a real broker.

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "tests/bench/broker.h"
#include "tests/bench/paho_clients.h"
#include "tests/bench/parts.h"
#include "tests/bench/site.h"

namespace bench {
namespace {

using std::chrono::steady_clock;

constexpr auto kStep = std::chrono::seconds(10);
constexpr auto kLongest = std::chrono::seconds(1);  ///< Later is not waited for.
// The simulated drive itself sends no such currents.
constexpr unsigned kFirst = 20000;
constexpr std::uint32_t kTpdo1OfPump1 = 0x185;

/// When each number was sent, or first seen.
using Times = std::map<unsigned, steady_clock::time_point>;

/// Sends pump1's TPDO1 at a steady rate, with a number as its output current (0.1 A).
class NumberedFrames {
 public:
  NumberedFrames(SiteInThread& site, unsigned rate) : site_(site), rate_(rate), timer_(site.loop()) {
    site_.on_loop([this] {
      link_ = site_.bus().connect();
      begin_ = steady_clock::now();
      step();
    });
  }
  ~NumberedFrames() { static_cast<void>(end()); }
  NumberedFrames(const NumberedFrames&) = delete;
  NumberedFrames& operator=(const NumberedFrames&) = delete;

  Times end() {
    site_.on_loop([this] {
      stop_ = true;
      timer_.cancel();
    });
    site_.on_loop([this] { link_.reset(); });
    return std::exchange(sent_, {});
  }

 private:
  void step() {
    if (stop_) {
      return;
    }
    const unsigned number = kFirst + count_++;
    canopen::Frame frame;
    frame.id = kTpdo1OfPump1;
    frame.size = 8;
    frame.data[2] = static_cast<std::uint8_t>(number);
    frame.data[3] = static_cast<std::uint8_t>(number >> 8U);
    sent_[number] = steady_clock::now();
    static_cast<void>(link_->send(frame));
    timer_.expires_at(begin_ + count_ * std::chrono::nanoseconds(std::chrono::seconds(1)) / rate_);
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (!error) {
        step();
      }
    });
  }

  SiteInThread& site_;
  unsigned rate_;
  boost::asio::steady_timer timer_;
  std::unique_ptr<canopen::Link> link_;
  steady_clock::time_point begin_{};
  Times sent_;
  unsigned count_ = 0;
  bool stop_ = false;
};

/// When the subscriber saw each number.
class Seen {
 public:
  void take(const std::string& payload) {
    const auto now = steady_clock::now();
    constexpr std::string_view kName = "\"output_current\":";
    const std::size_t at = payload.find(kName);
    if (at != std::string::npos) {
      const auto number = std::lround(std::strtod(payload.c_str() + at + kName.size(), nullptr) * 10);
      const std::lock_guard lock(mutex_);
      seen_.emplace(static_cast<unsigned>(number), now);
    }
  }
  Times end() {
    const std::lock_guard lock(mutex_);
    return std::exchange(seen_, {});
  }

 private:
  std::mutex mutex_;
  Times seen_;
};

void measure(SiteInThread& site, Seen& seen, unsigned rate) {
  static_cast<void>(seen.end());
  NumberedFrames frames(site, rate);
  std::this_thread::sleep_for(kStep);
  const Times sent = frames.end();
  std::this_thread::sleep_for(kLongest);
  const Times came = seen.end();
  std::vector<double> late;
  for (const auto& [number, at] : sent) {
    const auto arrival = came.find(number);
    if (arrival != came.end()) {
      late.push_back(std::chrono::duration<double, std::micro>(arrival->second - at).count());
    }
  }
  if (late.empty()) {
    throw std::runtime_error("no value arrived");
  }
  std::sort(late.begin(), late.end());
  fmt::print("{:<44} p50 {:.0f} us, p99 {:.0f} us, max {:.0f} us; {} values of {} frames\n",
             fmt::format("frame to MQTT subscriber, {} frames/s", rate), late[late.size() / 2],
             late[late.size() * 99 / 100], late.back(), late.size(), sent.size());
  std::fflush(stdout);
}

}  // namespace

void latency() {
  const std::uint16_t port = free_port();
  const Broker broker(port);
  Seen seen;
  const Subscriber subscriber(broker.uri(), "canopen/demo/pump1/state",
                              [&](const std::string& payload) { seen.take(payload); });
  config::Model model = demo_model(0, port);
  model.mqtt->signals = false;
  SiteInThread site(std::move(model));
  if (!site.wait_online()) {
    throw std::runtime_error("the simulated drives did not come online");
  }
  subscriber.wait_for_first();
  measure(site, seen, 1000);
  measure(site, seen, 20);
}

}  // namespace bench
