// The whole bridge on a real broker, and somebody who is subscribed there, while the plant's configuration changes.

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/bridge.h"
#include "bridges/mqtt/publisher.h"
#include "bridges/process/plant.h"
#include "bridges/process/plant_change.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "tests/support/spawn.h"
#include "tests/unit/mqtt/on_mosquitto.h"
#include "tests/unit/mqtt/site.h"

namespace mqtt {
namespace {

using test::output_of;

constexpr const char* kFanConfig = "homeassistant/device/canopen_line3/fan1/config";
constexpr const char* kPumpConfig = "homeassistant/device/canopen_line3/pump1/config";

/// Out of service, so that nothing is told of them that did not change.
config::Model model_with(const std::vector<std::string>& names) {
  config::Model model = test::model();
  model.mqtt->home_assistant = "homeassistant";
  const config::Drive drive = model.drives[0];
  model.drives.clear();
  for (const std::string& name : names) {
    model.drives.push_back(drive);
    model.drives.back().name = name;
    model.drives.back().node.node = static_cast<std::uint8_t>(model.drives.size());
    model.drives.back().enabled = false;
  }
  return model;
}

/// mosquitto_sub on everything, until the end.
class Subscriber {
 public:
  Subscriber(const std::string& at, std::string file)
      : file_(std::move(file)),
        process_(std::stoi(output_of("mosquitto_sub -V 5 -F '%r %t=%p'" + at +
                                     "-t 'canopen/#' -t 'homeassistant/#' > " + file_ + " 2>&1 & echo $!"))) {}
  ~Subscriber() { ::kill(process_, SIGTERM); }
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;

  /// `0 TOPIC=PAYLOAD`, with 1 where the broker had kept it; a line each.
  [[nodiscard]] std::string heard() const {
    std::ifstream file(file_);
    return "\n" + std::string(std::istreambuf_iterator<char>(file), {});
  }
  [[nodiscard]] bool has_heard(const std::string& line) const {
    return heard().find("\n" + line + "\n") != std::string::npos;
  }

 private:
  std::string file_;
  pid_t process_;
};

class ReloadOnMosquitto : public test::OnMosquitto {
 protected:
  void SetUp() override {
    test::OnMosquitto::SetUp();
    plant_.add(bridge_);
    bridge_.start();
    bus_.start();
    plant_.start();
    ASSERT_TRUE(run_until([this] { return bridge_.connected(); }));
    ASSERT_TRUE(run_until([this] { return retained(kFanConfig).size() > 3 && retained(kPumpConfig).size() > 3; }));
  }
  void TearDown() override {
    const auto ended =
        support::spawn(context.get_executor(), [](ReloadOnMosquitto& test) -> boost::asio::awaitable<void> {
          co_await test.bridge_.stop();
          co_await test.plant_.stop();
          co_await test.bus_.stop();
        }(*this));
    EXPECT_TRUE(run_until([&ended] { return *ended; }));
  }
  void change(config::Model model, std::vector<std::size_t> go, const process::PlantChange& from) {
    const auto stopped = support::spawn(context.get_executor(), plant_.stop(std::move(go)));
    ASSERT_TRUE(run_until([&stopped] { return *stopped; }));
    plant_.change(std::make_shared<const config::Model>(std::move(model)), {{&bus_, {}}}, from);
    plant_.forget_left();
  }

  canopen::VirtualBus can_{context.get_executor()};
  canopen::Bus bus_{
      context.get_executor(), can_.connect(), {.bitrate = 250000, .node_id = 127, .heartbeat = {}, .sync = {}}};
  config::Model model_ = model_with({"pump1", "fan1"});
  process::Plant plant_{context.get_executor(), model_, {{&bus_, {}}}};
  Bridge bridge_{
      context.get_executor(),
      plant_,
      *model_.mqtt,
      model_.gateway,
      "1.2.3",
      "00112233aabbccdd",
      std::make_unique<Publisher>(context.get_executor(), settings(broker_.port()), Notice([](auto&&...) {})),
      [](Level, const std::string&) {}};
};

TEST_F(ReloadOnMosquitto, OfADriveThatGoesNothingIsKeptAndOfAnotherNothingIsHeard) {
  const Subscriber subscriber(at(), (broker_.directory() / "heard").string());
  ASSERT_TRUE(run_until([&] { return subscriber.has_heard("1 canopen/line3/fan1/status=offline"); }));
  change(model_with({"pump1"}), {1}, {.drives = {0}, .buses = {0}});
  ASSERT_TRUE(run_until([&] { return subscriber.has_heard("0 canopen/line3/fan1/status="); })) << subscriber.heard();
  ASSERT_TRUE(run_until([&] { return subscriber.has_heard(std::string("0 ") + kFanConfig + "="); }));
  // What was said before this was heard before it.
  publish_with("-t canopen/end -m 1");
  ASSERT_TRUE(run_until([&] { return subscriber.has_heard("0 canopen/end=1"); }));
  const std::string heard = subscriber.heard();
  EXPECT_EQ(heard.find("\n0 canopen/line3/pump1/"), std::string::npos) << heard;
  EXPECT_EQ(heard.find(std::string("\n0 ") + kPumpConfig), std::string::npos) << heard;
  EXPECT_EQ(heard.find("\n0 canopen/line3/status="), std::string::npos) << heard;
  EXPECT_NE(heard.find("\n0 canopen/line3/info="), std::string::npos) << heard;
  const Subscriber later(at(), (broker_.directory() / "later").string());
  ASSERT_TRUE(run_until([&] { return later.has_heard("1 canopen/line3/pump1/status=offline"); }));
  publish_with("-t canopen/end -m 2");  // All that is kept comes before it.
  ASSERT_TRUE(run_until([&] { return later.has_heard("0 canopen/end=2"); }));
  EXPECT_EQ(later.heard().find("fan1"), std::string::npos) << later.heard();
  EXPECT_NE(later.heard().find(std::string("\n1 ") + kPumpConfig + "={"), std::string::npos) << later.heard();
}

}  // namespace
}  // namespace mqtt
