#include <gtest/gtest.h>

#include <string>

#include "canopen/bus/virtual_link.h"
#include "config/bus_load.h"
#include "config/load.h"
#include "daemon/gateway.h"
#include "daemon/simulated_site.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

// The forecast beside what the gateway measures: the whole gateway and simulated drives on an in-process bus.

namespace gateway {
namespace {

using namespace std::chrono_literals;

config::Model model_of(const std::string& text) {
  const config::Loaded loaded = config::load_text(
      text, {.file = "gateway.toml", .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = "host"});
  for (const config::Finding& finding : loaded.findings) {
    EXPECT_EQ(finding.level, config::Finding::Level::warning) << to_string(finding);
  }
  return loaded.model.value_or(config::Model{});
}

/// What the gateway measures in the ten seconds after all drives are online, motors at rest. It tells the load of the
/// last second, so ten figures cover them without a gap. The tenth of a second in which the last drive came is counted
/// as a whole, with what is left of its boot.
double measure_load(const config::Model& model) {
  support::HandDrivenLoop loop;
  canopen::VirtualBus wire(loop.executor());
  SimulatedSite site(loop.executor());
  site.add_drives(site.add_network(wire.connect()), model, 0);
  Gateway gateway(loop.executor(), model, [&](const config::Bus&) { return wire.connect(); });
  gateway.start();
  site.start();
  const process::Plant& plant = gateway.plant();
  EXPECT_TRUE(loop.advance_until([&] { return plant.online() == plant.size(); }, 30s));
  double per_mille = 0;
  for (int second = 0; second < 10; ++second) {
    loop.advance(1s);
    per_mille += plant.bus_statistics(0).load_per_mille;
  }
  EXPECT_EQ(plant.online(), plant.size());
  for (const auto& drive : site.drives()) {
    EXPECT_EQ(drive->record().run_commands, 0U);
  }
  const auto stopped = support::spawn(loop.executor(), gateway.stop());
  EXPECT_TRUE(loop.advance_until([&] { return *stopped; }, 5s));
  site.stop();
  loop.settle();
  return per_mille / 10 / 1000;
}

void expect_forecast_near_measured(const config::Model& model) {
  const auto forecast = config::forecast_load(model, 0);
  ASSERT_TRUE(forecast.has_value());
  const double measured = measure_load(model);
  EXPECT_GT(measured, 0.05);
  // Less than the share of the heartbeats.
  EXPECT_NEAR(forecast->usual, measured, 0.02 * measured);
  EXPECT_GT(forecast->worst, measured);
}

std::string bus_text(int bitrate, const std::string& more = "") {
  return "[[bus]]\nname = \"can0\"\nbitrate = " + std::to_string(bitrate) + "\n" + more;
}

class VeichiForecast : public testing::TestWithParam<std::tuple<int, int>> {};

TEST_P(VeichiForecast, IsWhatTheGatewayMeasures) {
  const auto [drives, bitrate] = GetParam();
  std::string text = bus_text(bitrate);
  for (int node = 1; node <= drives; ++node) {
    text += "[[drive]]\nname = \"drive" + std::to_string(node) + "\"\nnode = " + std::to_string(node) +
            "\nprofile = \"" + (node % 2 == 0 ? "veichi-ac300" : "veichi-ac310") + "\"\n";
  }
  expect_forecast_near_measured(model_of(text));
}

INSTANTIATE_TEST_SUITE_P(Sites, VeichiForecast,
                         testing::Combine(testing::Values(8, 24), testing::Values(125000, 250000)),
                         [](const auto& site) {
                           return std::to_string(std::get<0>(site.param)) + "DrivesAt" +
                                  std::to_string(std::get<1>(site.param) / 1000) + "kbit";
                         });

// Everything else that is forecast: SYNC and what comes with it, polls that are most of the load, other heartbeats.
TEST(BusLoadForecast, OfSyncPollsAndOtherDrivesIsWhatTheGatewayMeasures) {
  const std::string poll = "[drive.signals.error_register]\nobject = \"0x1001\"\ntype = \"u8\"\naddress = 300\npoll = ";
  expect_forecast_near_measured(
      model_of(bus_text(125000, "sync = \"50ms\"\nheartbeat = \"200ms\"\n") +
               "[[drive]]\nname = \"hoist1\"\nnode = 7\nprofile = \"invt-goodrive600\"\nheartbeat = \"100ms\"\n"
               "heartbeat_timeout = \"300ms\"\n[drive.tpdo2]\ntransmission_type = 2\ninhibit_time = \"0s\"\n" +
               poll + "\"20ms\"\n" +
               "[[drive]]\nname = \"mixer1\"\nnode = 9\nprofile = \"vacon-opte6\"\nsupervise_gateway = \"2s\"\n" +
               poll + "\"40ms\"\n"));
}

}  // namespace
}  // namespace gateway
