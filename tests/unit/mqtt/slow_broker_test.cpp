// Sixteen simulated drives that ramp, the bridge, the real publisher, and a broker that takes one message each 20 ms of
// a time that the test moves by hand.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/bridge.h"
#include "bridges/mqtt/publisher.h"
#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/subscription.h"
#include "canopen/bus/virtual_link.h"
#include "config/load.h"
#include "simulator/drive.h"
#include "simulator/network.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"
#include "tests/unit/mqtt/tiny_broker.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::TinyBroker;

constexpr std::size_t kDrives = 16;
constexpr canopen::Duration kTake = 20ms;
constexpr std::size_t kSecond = 1s / kTake;  ///< In messages that the broker takes.
constexpr std::uint8_t kGatewayNode = 127;
constexpr std::uint16_t kOvercurrentCode = 0x0006;
constexpr double kStep = 0.02;  ///< In Hz: what one state may be off by rounding.

std::string name_of(std::size_t drive) {
  return "fan" + std::to_string(drive + 1);
}

config::Model model_on(std::uint16_t broker_port) {
  std::string site =
      "[gateway]\nname = \"line3\"\n[[bus]]\nname = \"can0\"\ninterface = \"virtual\"\n"
      "[mqtt]\nmin_interval = \"50ms\"\nbrokers = [\"mqtt://127.0.0.1:" +
      std::to_string(broker_port) + "\"]\n";
  for (std::size_t drive = 0; drive < kDrives; ++drive) {
    site += "[[drive]]\nname = \"" + name_of(drive) + "\"\nnode = " + std::to_string(drive + 1) +
            "\nprofile = \"veichi-ac310\"\n[drive.commands]\nwriters = [\"mqtt\"]\n";
  }
  config::Loaded loaded = config::load_text(
      site, {.file = "site.toml", .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = "host"});
  if (!loaded.model) {
    throw std::invalid_argument("the site does not load: " + config::to_string(loaded.findings.front()));
  }
  return *std::move(loaded.model);
}

using Frequencies = std::array<double, kDrives>;

/// What the broker took from the moment on that it was slow, and each motor's frequency just before.
struct Taken {
  std::vector<std::string> messages;  ///< topic=payload
  std::vector<Frequencies> ramps;

  /// Position of the first message that begins so.
  [[nodiscard]] std::size_t first(const std::string& text) const {
    const auto found = std::ranges::find_if(messages, [&](const std::string& each) { return each.starts_with(text); });
    return static_cast<std::size_t>(found - messages.begin());
  }
  /// How many messages ago the frequency was true that this state of the drive tells; nothing where it is none.
  [[nodiscard]] std::optional<std::size_t> age_of_state(std::size_t position, std::size_t drive) const {
    const std::string& message = messages.at(position);
    if (!message.starts_with("canopen/line3/" + name_of(drive) + "/state=")) {
      return std::nullopt;
    }
    const std::string member = "\"output_frequency\":";
    const double told = std::stod(message.substr(message.find(member) + member.size()));
    std::size_t age = 0;
    while (age < position && ramps[position - age].at(drive) > told + kStep) {
      ++age;
    }
    return age;
  }
};

class SlowBroker : public testing::Test {
 protected:
  SlowBroker() {
    network_.open();
    for (std::size_t i = 0; i < kDrives; ++i) {
      drives_.push_back(simulator::make_drive("veichi-ac310", static_cast<std::uint8_t>(i + 1), network_));
      drives_.back()->power_on();
    }
    plant_.add(bridge_);
    bridge_.start();
    bus_.start();
    plant_.start();
  }
  ~SlowBroker() override {
    broker_.take_all();
    const auto ended = support::spawn(loop_.executor(), [](SlowBroker& site) -> boost::asio::awaitable<void> {
      co_await site.bridge_.stop();
      co_await site.plant_.stop();
      co_await site.bus_.stop();
    }(*this));
    EXPECT_TRUE(wait_until([&ended] { return *ended; }));
  }

  /// Waits for what another thread does; little simulated time passes.
  template <class Predicate>
  [[nodiscard]] bool wait_until(Predicate done) {
    for (int tries = 0; tries < 2000 && !done(); ++tries) {
      loop_.context().run_one_for(10ms);
      loop_.advance(1ms);
    }
    return done();
  }
  void ramp() {
    for (const auto& drive : drives_) {
      drive->motor().set_ramps(4, 4);
      drive->motor().set_target(50);
      drive->motor().run(false);
    }
  }
  /// Each motor's frequency as it is now.
  [[nodiscard]] Frequencies frequencies() const {
    Frequencies now{};
    std::ranges::transform(drives_, now.begin(), [](const auto& drive) { return drive->motor().output_hz(); });
    return now;
  }
  void take_one(Taken& taken) {
    taken.ramps.push_back(frequencies());
    loop_.advance(kTake, 5ms);
    ASSERT_TRUE(broker_.take_one());
    taken.messages.push_back(broker_.published().back());
  }
  [[nodiscard]] std::uint64_t writes_to(std::size_t drive) const {
    return simulator::Record::total(drives_[drive]->record().sdo_writes);
  }

  support::HandDrivenLoop loop_;
  TinyBroker broker_{{.speaks_5 = true, .by_hand = true}};
  config::Model model_{model_on(broker_.port())};
  canopen::VirtualBus wire_{loop_.executor()};
  simulator::Network network_{loop_.executor(), wire_.connect()};
  std::vector<std::unique_ptr<simulator::Drive>> drives_;
  canopen::Bus bus_{
      loop_.executor(), wire_.connect(), {.bitrate = 1000000, .node_id = kGatewayNode, .heartbeat = {}, .sync = {}}};
  process::Plant plant_{loop_.executor(), model_, {{&bus_, [this] { return bus_.statistics(); }}}};
  canopen::Subscription bus_state_{
      bus_.subscribe_state([this](const canopen::BusState& state) { plant_.set_bus_state(0, state); })};
  Bridge bridge_{loop_.executor(),
                 plant_,
                 *model_.mqtt,
                 model_.gateway,
                 "1.2.3",
                 "00112233aabbccdd",
                 std::make_unique<Publisher>(loop_.executor(), publisher_settings(*model_.mqtt, model_.gateway),
                                             [](Level, const std::string&) {}),
                 [](Level, const std::string&) {}};
};

TEST_F(SlowBroker, GetsAlarmsAndAnswersAtOnceAndNoStateThatIsOld) {
  constexpr std::size_t kTime = 10 * kSecond;
  constexpr std::size_t kRaised = 3 * kSecond;
  constexpr std::size_t kFaulty = kDrives - 1;
  constexpr std::size_t kCommanded = kDrives - 2;
  broker_.take_all();
  ASSERT_TRUE(loop_.advance_until([this] { return plant_.online() == kDrives; }, 30s));
  ASSERT_TRUE(wait_until([this] { return bridge_.connected(); }));
  ramp();
  broker_.take_by_hand();

  Taken taken;
  while (taken.messages.size() < kTime) {
    if (taken.messages.size() == kRaised) {
      drives_[kFaulty]->fault(kOvercurrentCode);
      const std::uint64_t written = writes_to(kCommanded);
      broker_.deliver("canopen/line3/" + name_of(kCommanded) + "/frequency_command/set", R"({"value":49.5,"id":"a1"})");
      ASSERT_TRUE(wait_until([&] { return writes_to(kCommanded) > written; }));
    }
    ASSERT_NO_FATAL_FAILURE(take_one(taken));
  }
  EXPECT_GT(taken.ramps.back()[0], taken.ramps[kRaised][0] + 20) << "they ramped all the while";

  const std::size_t alarm = taken.first("canopen/line3/" + name_of(kFaulty) + "/alarm/emcy={\"active\":true");
  const std::size_t answer = taken.first("canopen/line3/result={\"ok\":true");
  EXPECT_GT(alarm, kRaised);
  EXPECT_LT(alarm, kRaised + kSecond);
  EXPECT_GT(answer, kRaised);
  EXPECT_LT(answer, kRaised + kSecond);

  std::size_t oldest = 0;
  for (std::size_t drive = 0; drive < kCommanded; ++drive) {
    std::size_t states = 0;
    for (std::size_t position = 2 * kSecond; position < kTime; ++position) {
      const auto age = taken.age_of_state(position, drive);
      states += age ? 1U : 0U;
      oldest = std::max(oldest, age.value_or(0));
    }
    EXPECT_GT(states, 0U) << name_of(drive);
  }
  EXPECT_LT(oldest, 2 * kSecond);
  std::printf("after so many messages: an alarm %zu, an answer %zu; the oldest state %zu\n", alarm - kRaised,
              answer - kRaised, oldest);
}

}  // namespace
}  // namespace mqtt
