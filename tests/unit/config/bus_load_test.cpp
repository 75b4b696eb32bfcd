#include "config/bus_load.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/unit/config/site.h"

namespace config {
namespace {

using namespace std::chrono_literals;
using canopen::DataType;
using canopen::PdoSettings;

// Bits of a frame with 0, 1, 6 and 8 data bytes, worked out by hand: 47 + 8 per byte, and of the 34 + 8 per byte that
// can be stuffed a tenth, or at worst a quarter of all but the first.
constexpr double kUsual0 = 47 + 3;
constexpr double kWorst0 = 47 + 8;
constexpr double kUsual1 = 55 + 4;
constexpr double kWorst1 = 55 + 10;
constexpr double kUsual6 = 95 + 8;
constexpr double kWorst6 = 95 + 20;
constexpr double kUsual8 = 111 + 9;
constexpr double kWorst8 = 111 + 24;

/// A bus of 1 000 000 bit/s on which nothing is sent, and one drive that sends nothing either.
Model silent_model() {
  Model model;
  Bus bus;
  bus.bitrate = 1'000'000;
  bus.heartbeat = {};
  model.buses.push_back(bus);
  Drive drive;
  drive.node.error_control.heartbeat = {};
  model.drives.push_back(drive);
  return model;
}

BusLoad load_of(const Model& model) {
  const auto load = forecast_load(model, 0);
  EXPECT_TRUE(load.has_value());
  return load.value_or(BusLoad{});
}

/// Forecast bits per second.
void expect_bits(const Model& model, double usual, double worst) {
  const BusLoad load = load_of(model);
  EXPECT_NEAR(load.usual * 1e6, usual, 1e-6);
  EXPECT_NEAR(load.worst * 1e6, worst, 1e-6);
}

PdoSettings pdo_of(unsigned words) {
  PdoSettings pdo;
  pdo.mapping.resize(words);
  return pdo;
}

/// A TPDO of eight bytes.
PdoSettings tpdo_of(std::optional<std::uint8_t> type, Duration period, Duration shortest_period = {}) {
  PdoSettings tpdo = pdo_of(4);
  tpdo.transmission_type = type;
  tpdo.period = period;
  tpdo.shortest_period = shortest_period;
  return tpdo;
}

Model model_with(const PdoSettings& tpdo) {
  Model model = silent_model();
  model.drives[0].node.tpdos.push_back(tpdo);
  return model;
}

Signal polled(std::uint16_t index, DataType type, Duration poll) {
  Signal signal;
  signal.object = {index, 0};
  signal.type = type;
  signal.poll = poll;
  return signal;
}

TEST(BusLoadForecast, NeedsABitrate) {
  Model model = silent_model();
  model.buses[0].bitrate.reset();
  EXPECT_FALSE(forecast_load(model, 0).has_value());
}

TEST(BusLoadForecast, IsZeroWhereNothingIsSent) {
  expect_bits(silent_model(), 0, 0);
  EXPECT_FALSE(load_of(silent_model()).at_least);
}

TEST(BusLoadForecast, CountsHeartbeats) {
  Model model = silent_model();
  model.buses[0].heartbeat = 500ms;
  model.drives[0].node.error_control.heartbeat = 250ms;
  expect_bits(model, (2 + 4) * kUsual1, (2 + 4) * kWorst1);
  model.buses[0].node_id = 0;
  expect_bits(model, 4 * kUsual1, 4 * kWorst1);
}

TEST(BusLoadForecast, CountsGuardingRequestsAndTheirAnswers) {
  Model model = silent_model();
  model.drives[0].node.error_control.guarding = 250ms;
  expect_bits(model, 4 * (kUsual0 + kUsual1), 4 * (kWorst0 + kWorst1));
}

TEST(BusLoadForecast, CountsSyncEvenOfAGatewayWithoutANodeId) {
  Model model = silent_model();
  model.buses[0].sync = 100ms;
  model.buses[0].node_id = 0;
  expect_bits(model, 10 * kUsual0, 10 * kWorst0);
}

TEST(BusLoadForecast, CountsATpdoByItsLength) {
  PdoSettings tpdo = pdo_of(3);
  tpdo.transmission_type = 1;
  tpdo.period = 100ms;
  expect_bits(model_with(tpdo), 10 * kUsual6, 10 * kWorst6);
  tpdo.mapping.resize(1);
  tpdo.mapping[0].bits = 3;
  expect_bits(model_with(tpdo), 10 * kUsual1, 10 * kWorst1);
  tpdo.mapping.clear();
  expect_bits(model_with(tpdo), 10 * kUsual0, 10 * kWorst0);
}

TEST(BusLoadForecast, CountsSynchronousTpdosByTheirPeriod) {
  const Model model = model_with(tpdo_of(4, 400ms));
  expect_bits(model, 2.5 * kUsual8, 2.5 * kWorst8);
  EXPECT_FALSE(load_of(model).at_least);
}

TEST(BusLoadForecast, TypeZeroComesAtMostWithEverySync) {
  Model model = model_with(tpdo_of(0, 0ms));
  model.buses[0].sync = 100ms;
  expect_bits(model, 10 * kUsual0, 10 * (kWorst0 + kWorst8));
  EXPECT_FALSE(load_of(model).at_least);
}

TEST(BusLoadForecast, OnChangeWithoutAnInhibitTimeIsAtLeastItsEventTimer) {
  for (const std::optional<std::uint8_t> type :
       {std::optional<std::uint8_t>(254), std::optional<std::uint8_t>(255), std::optional<std::uint8_t>()}) {
    Model model = model_with(tpdo_of(type, 100ms));
    expect_bits(model, 10 * kUsual8, 10 * kWorst8);
    EXPECT_TRUE(load_of(model).at_least);
    model.drives[0].node.tpdos[0].period = {};
    expect_bits(model, 0, 0);
    EXPECT_TRUE(load_of(model).at_least);
  }
}

TEST(BusLoadForecast, OnChangeComesAtMostAsOftenAsItsInhibitTimeAllows) {
  const Model model = model_with(tpdo_of(255, 100ms, 20ms));
  expect_bits(model, 10 * kUsual8, 50 * kWorst8);
  EXPECT_FALSE(load_of(model).at_least);
  expect_bits(model_with(tpdo_of(255, 0ms, 20ms)), 0, 50 * kWorst8);
}

TEST(BusLoadForecast, AnInhibitTimeAlsoSlowsTheEventTimer) {
  expect_bits(model_with(tpdo_of(255, 100ms, 200ms)), 5 * kUsual8, 5 * kWorst8);
}

class RpdoForecast : public testing::Test {
 protected:
  RpdoForecast() {
    PdoSettings rpdo = pdo_of(3);
    rpdo.event_timer = 300;
    model_.drives[0].node.rpdos.push_back(rpdo);
    model_.drives[0].commands.writers.mqtt = true;
  }
  PdoSettings& rpdo() { return model_.drives[0].node.rpdos[0]; }

  Model model_ = silent_model();
};

TEST_F(RpdoForecast, IsThreeTimesPerEventTimerOnceCommanded) {
  expect_bits(model_, 0, 10 * kWorst6);
  rpdo().event_timer = 1;  // The gateway repeats every 5 ms at most.
  expect_bits(model_, 0, 200 * kWorst6);
}

TEST_F(RpdoForecast, IsNothingWhereTheDriveDoesNotSupervise) {
  rpdo().event_timer = 0;
  expect_bits(model_, 0, 0);
  rpdo().event_timer.reset();
  expect_bits(model_, 0, 0);
}

TEST_F(RpdoForecast, IsNothingWhereNobodyMayCommand) {
  model_.drives[0].commands.writers = {};
  expect_bits(model_, 0, 0);
}

TEST_F(RpdoForecast, IsNothingWhereAFieldHasNoMeaning) {
  rpdo().mapping[1].use = canopen::FieldUse::unused;
  expect_bits(model_, 0, 10 * kWorst6);
  rpdo().mapping[1].use = canopen::FieldUse::unnamed;
  expect_bits(model_, 0, 0);
}

TEST(BusLoadForecast, CountsRequestAndAnswerOfAPoll) {
  Model model = silent_model();
  model.drives[0].signals = {polled(0x2000, DataType::u32, 500ms)};
  expect_bits(model, 2 * 2 * kUsual8, 2 * 2 * kWorst8);
  EXPECT_NEAR(load_of(model).polls_worst * 1e6, 2 * 2 * kWorst8, 1e-6);
}

TEST(BusLoadForecast, CountsTheSegmentsOfEightBytes) {
  Model model = silent_model();
  model.drives[0].signals = {polled(0x2000, DataType::u64, 1s)};
  expect_bits(model, 3 * 2 * kUsual8, 3 * 2 * kWorst8);
}

TEST(BusLoadForecast, PollsAnObjectOnceForAllItsSignals) {
  Model model = silent_model();
  Signal derived = polled(0x2000, DataType::boolean, 10ms);
  derived.derived = Derived{};
  model.drives[0].signals = {polled(0x2000, DataType::u16, 500ms), polled(0x2000, DataType::i16, 250ms), derived,
                             polled(0x2001, DataType::u16, 1s)};
  expect_bits(model, (4 + 1) * 2 * kUsual8, (4 + 1) * 2 * kWorst8);
}

TEST(BusLoadForecast, PollsNothingThatATpdoBringsOrNobodyReads) {
  Model model = silent_model();
  Signal mapped = polled(0x2000, DataType::u16, 1s);
  mapped.source = {SourceKind::tpdo, 1};
  Signal written = polled(0x2001, DataType::u16, 1s);
  written.access = Access::write;
  model.drives[0].signals = {mapped, written};
  expect_bits(model, 0, 0);
  model.drives[0].signals[1].access = Access::read_write;
  expect_bits(model, 2 * kUsual8, 2 * kWorst8);
}

TEST(BusLoadForecast, TellsThePollsFromTheRest) {
  Model model = model_with(tpdo_of(1, 100ms));
  model.drives[0].signals = {polled(0x2000, DataType::u16, 1s)};
  const BusLoad load = load_of(model);
  EXPECT_NEAR(load.worst * 1e6, (10 + 2) * kWorst8, 1e-6);
  EXPECT_NEAR(load.polls_worst * 1e6, 2 * kWorst8, 1e-6);
}

TEST(BusLoadForecast, CountsTheDrivesOfItsBusOnly) {
  Model model = model_with(tpdo_of(255, 100ms));
  model.buses.push_back(model.buses[0]);
  model.buses[1].bitrate = 10000;
  model.drives.push_back(model.drives[0]);
  model.drives.push_back(model.drives[0]);
  model.drives[2].bus = 1;
  expect_bits(model, 2 * 10 * kUsual8, 2 * 10 * kWorst8);
  const auto other = forecast_load(model, 1);
  ASSERT_TRUE(other.has_value());
  EXPECT_NEAR(other->worst, 10 * kWorst8 / 10000, 1e-9);
  EXPECT_TRUE(other->at_least);
  model.drives[2].node.tpdos.clear();
  EXPECT_FALSE(forecast_load(model, 1)->at_least);
}

TEST(BusLoadForecast, MayBeMoreThanTheBusCarries) {
  Model model = model_with(tpdo_of(1, 1ms));
  model.buses[0].bitrate = 10000;
  EXPECT_GT(load_of(model).worst, 10);
}

/// `23 / 26 %`: usual and worst.
std::string cell_of(int drives, int bitrate) {
  std::string text = kBus + "bitrate = " + std::to_string(bitrate) + "\n";
  for (int node = 1; node <= drives; ++node) {
    text += "[[drive]]\nname = \"drive" + std::to_string(node) + "\"\nnode = " + std::to_string(node) +
            "\nprofile = \"veichi-ac310\"\n";
  }
  const BusLoad load = load_of(model_of(text));
  EXPECT_TRUE(load.at_least);
  return std::to_string(std::lround(100 * load.usual)) + " / " + std::to_string(std::lround(100 * load.worst)) + " %";
}

TEST(TheManual, ShowsWhatIsForecastForVeichiDrives) {
  std::string rows;
  for (const int drives : {8, 16, 24, 32}) {
    rows += "| " + std::to_string(drives) + " |";
    for (const int bitrate : {125'000, 250'000, 500'000}) {
      rows += " " + cell_of(drives, bitrate) + " |";
    }
    rows += "\n";
  }
  std::ifstream in(GATEWAY_SOURCE_DIR "/docs/CONFIGURATION.md");
  const std::string manual{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(manual.find(rows), std::string::npos) << "the rows of the table under \"Bus load\" are now\n" << rows;
}

}  // namespace
}  // namespace config
