// What a storm of emergencies costs those who read and command: round trips beside 1000 of them in a second, against
// round trips just before.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <stdexcept>

#include "tests/bench/broker.h"
#include "tests/bench/bus_load.h"
#include "tests/bench/paho_clients.h"
#include "tests/bench/parts.h"
#include "tests/bench/round_trips.h"
#include "tests/bench/site.h"

namespace bench {
namespace {

constexpr int kRounds = 5;
constexpr unsigned kEmergencies = 1000;  ///< A second.
constexpr std::uint32_t kEmcyOfPump1 = 0x085;

// Of a drive that says in turn that an error came and that all are gone.
canopen::Frame emergency(std::uint64_t number) {
  canopen::Frame frame;
  frame.id = kEmcyOfPump1;
  frame.size = 8;
  if (number % 2 == 0) {
    frame.data = {static_cast<std::uint8_t>(1 + number / 2 % 20), 0, 1};
  }
  return frame;
}

void measure(SiteInThread& site, const std::string& what, const std::function<void()>& call) {
  RoundTrips times{.what = what, .before = {}, .during = {}};
  for (int round = 0; round <= kRounds; ++round) {
    const double quiet = p99(call);
    BusLoad storm(site, kEmergencies, emergency);
    const double stormy = p99(call);
    if (storm.sent() < kEmergencies * 9 / 10) {
      throw std::runtime_error(fmt::format("the storm was {} emergencies only", storm.sent()));
    }
    if (round > 0) {
      times.before.push_back(quiet);
      times.during.push_back(stormy);
    }
  }
  print(times);
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
  RoundTripClient client(modbus_port, *pump1->unit);
  measure(site, "1000 emergencies/s, Modbus reads", [&] { client.read(); });
  measure(site, "1000 emergencies/s, Modbus set-points", [&] { client.command(); });
}

}  // namespace bench
