// What a storm of emergencies costs those who read and command: round trips beside 1000 of them in a second, against
// round trips just before.

#include <fmt/format.h>
#include <modbus/modbus.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

#include "tests/bench/broker.h"
#include "tests/bench/paho_clients.h"
#include "tests/bench/parts.h"
#include "tests/bench/rates.h"
#include "tests/bench/site.h"

namespace bench {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kRounds = 5;
constexpr milliseconds kRound{1000};
constexpr unsigned kEmergencies = 1000;  ///< In a round.
constexpr std::uint32_t kEmcyOfPump1 = 0x085;

/// Emergencies of a drive that says in turn that an error came and that all are gone, evenly over the time.
class Storm {
 public:
  explicit Storm(SiteInThread& site) : site_(site), timer_(site.loop()) {
    site_.on_loop([this] {
      link_ = site_.bus().connect();
      begin_ = steady_clock::now();
      step();
    });
  }
  ~Storm() {
    site_.on_loop([this] {
      stop_ = true;
      timer_.cancel();
    });
    site_.on_loop([this] { link_.reset(); });
  }
  Storm(const Storm&) = delete;
  Storm& operator=(const Storm&) = delete;

  [[nodiscard]] unsigned sent() {
    unsigned sent = 0;
    site_.on_loop([&] { sent = sent_; });
    return sent;
  }

 private:
  void step() {
    if (stop_) {
      return;
    }
    const auto due = static_cast<unsigned>((steady_clock::now() - begin_) * kEmergencies / kRound);
    for (; sent_ < std::min(due, kEmergencies); ++sent_) {
      canopen::Frame frame;
      frame.id = kEmcyOfPump1;
      frame.size = 8;
      if (sent_ % 2 == 0) {
        frame.data = {static_cast<std::uint8_t>(1 + sent_ / 2 % 20), 0, 1};
      }
      static_cast<void>(link_->send(frame));
    }
    timer_.expires_after(milliseconds(1));
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (!error) {
        step();
      }
    });
  }

  SiteInThread& site_;
  boost::asio::steady_timer timer_;
  std::unique_ptr<canopen::Link> link_;
  steady_clock::time_point begin_{};
  unsigned sent_ = 0;
  bool stop_ = false;
};

/// The time that 99 of 100 calls need at most, in microseconds.
double p99(const std::function<void()>& call) {
  std::vector<double> times;
  const auto begin = steady_clock::now();
  for (auto now = begin; now - begin < kRound;) {
    call();
    const auto after = steady_clock::now();
    times.push_back(std::chrono::duration<double, std::micro>(after - now).count());
    now = after;
  }
  const auto place = times.begin() + static_cast<std::ptrdiff_t>(times.size() * 99 / 100);
  std::nth_element(times.begin(), place, times.end());
  return *place;
}

class Client {
 public:
  Client(std::uint16_t port, std::uint8_t unit) : context_(modbus_new_tcp("127.0.0.1", port), modbus_free) {
    if (!context_ || modbus_set_slave(context_.get(), unit) != 0 || modbus_connect(context_.get()) != 0) {
      throw std::runtime_error("cannot connect to the Modbus server");
    }
  }
  ~Client() { modbus_close(context_.get()); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void read() {
    std::array<std::uint16_t, 10> words{};
    if (modbus_read_registers(context_.get(), 1000, 10, words.data()) != 10) {
      throw std::runtime_error("no normal answer to a read");
    }
  }
  /// A set-point that the drive has to confirm.
  void command() {
    if (modbus_write_register(context_.get(), 101, static_cast<std::uint16_t>(1000 + ++commands_ % 1000)) != 1) {
      throw std::runtime_error("a set-point is not confirmed");
    }
  }

 private:
  std::unique_ptr<modbus_t, void (*)(modbus_t*)> context_;
  unsigned commands_ = 0;
};

void measure(SiteInThread& site, const std::string& what, const std::function<void()>& call) {
  std::vector<double> before;
  std::vector<double> during;
  for (int round = 0; round <= kRounds; ++round) {
    const double quiet = p99(call);
    Storm storm(site);
    const double stormy = p99(call);
    if (storm.sent() < kEmergencies * 9 / 10) {
      throw std::runtime_error(fmt::format("the storm was {} emergencies only", storm.sent()));
    }
    if (round > 0) {
      before.push_back(quiet);
      during.push_back(stormy);
    }
  }
  std::vector<double> ratios;
  for (std::size_t i = 0; i < before.size(); ++i) {
    ratios.push_back(during[i] / before[i]);
  }
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  fmt::print("{:<44} p99 before  {:>10.0f} us, in it   {:>10.0f} us, ratio {:.2f} ({:.2f}..{:.2f})\n", what,
             median(before), median(during), median(ratios), *least, *most);
  std::fflush(stdout);
}

/// Removed at its end.
class StateDirectory {
 public:
  StateDirectory() : path_(std::filesystem::temp_directory_path() / fmt::format("gateway-bench-state-{}", getpid())) {
    std::filesystem::create_directory(path_);
  }
  ~StateDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  StateDirectory(const StateDirectory&) = delete;
  StateDirectory& operator=(const StateDirectory&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

void storm() {
  const StateDirectory state;
  const std::uint16_t broker_port = free_port();
  const Broker broker(broker_port);
  const std::uint16_t modbus_port = free_port();
  config::Model model = demo_model(modbus_port, broker_port);
  model.gateway.state_dir = state.path();
  Subscriber messages(broker.uri(), "canopen/demo/pump1/#");
  SiteInThread site(std::move(model));
  if (!site.wait_online()) {
    throw std::runtime_error("the simulated drives did not come online");
  }
  messages.wait_for_first();
  const auto& drives = site.model().drives;
  const auto pump1 =
      std::find_if(drives.begin(), drives.end(), [](const auto& drive) { return drive.name == "pump1"; });
  Client client(modbus_port, *pump1->unit);
  measure(site, "1000 emergencies/s, Modbus reads", [&] { client.read(); });
  measure(site, "1000 emergencies/s, Modbus set-points", [&] { client.command(); });
}

}  // namespace bench
