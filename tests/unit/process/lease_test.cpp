// Who keeps a drive to himself: two Modbus clients, MQTT and the command line against each other.

#include "bridges/process/lease.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

namespace process {
namespace {

using namespace std::chrono_literals;

const Writer kPlc{.way = Writer::Way::modbus, .address = "192.0.2.7"};
const Writer kPanel{.way = Writer::Way::modbus, .address = "192.0.2.8"};
const Writer kMqtt{.way = Writer::Way::mqtt, .address = {}};
const Writer kLocal{.way = Writer::Way::local, .address = {}};

/// A command, when it comes, and what the lease says: nothing, or how its refusal begins.
struct Step {
  std::chrono::milliseconds at;
  Writer writer;
  ControlUse use;
  std::string refusal;
};

struct LeaseCase {
  std::string name;
  std::vector<Step> steps;
  std::string holder;  ///< After the last step; empty: nobody.
};

std::string name_of_case(const testing::TestParamInfo<LeaseCase>& info) {
  return info.param.name;
}

class LeaseCases : public testing::TestWithParam<LeaseCase> {
 protected:
  canopen::ManualTime time_;
};

TEST_P(LeaseCases, EachCommandIsTakenOrRefused) {
  Lease lease(10s);
  const canopen::TimePoint start = canopen::Clock::now();
  canopen::TimePoint now = start;
  for (const Step& step : GetParam().steps) {
    now = start + step.at;
    const auto refusal = lease.refuse(step.writer, step.use, now);
    const std::string where = to_string(step.writer) + " after " + std::to_string(step.at.count()) + " ms";
    EXPECT_EQ(refusal.has_value(), !step.refusal.empty()) << where << ": " << refusal.value_or("taken");
    EXPECT_EQ(refusal.value_or("").substr(0, step.refusal.size()), step.refusal) << where;
    if (!refusal) {
      lease.on_accepted(step.writer, step.use, now);
    }
  }
  lease.expire(now);
  EXPECT_EQ(lease.holder() ? to_string(*lease.holder()) : "", GetParam().holder);
}

constexpr auto kNone = ControlUse::none;
constexpr auto kRun = ControlUse::run;
constexpr auto kStop = ControlUse::stop;
constexpr auto kMomentary = ControlUse::momentary;

INSTANTIATE_TEST_SUITE_P(
    Against, LeaseCases,
    testing::Values(
        LeaseCase{"FirstTakesIt", {{0ms, kPlc, kRun, ""}}, "modbus 192.0.2.7"},
        LeaseCase{"OtherModbusClient",
                  {{0ms, kPlc, kRun, ""},
                   {5800ms, kPanel, kNone, "modbus 192.0.2.7 holds the lease, for another 4.2 s unless renewed"}},
                  "modbus 192.0.2.7"},
        LeaseCase{"MqttAgainstModbus",
                  {{0ms, kPlc, kNone, ""}, {1ms, kMqtt, kRun, "modbus 192.0.2.7 holds the lease, for another 10.0 s"}},
                  "modbus 192.0.2.7"},
        LeaseCase{"LocalAgainstMqtt",
                  {{0ms, kMqtt, kRun, ""}, {9999ms, kLocal, kRun, "mqtt holds the lease, for another 0.1 s"}},
                  "mqtt"},
        LeaseCase{"ModbusAgainstLocal", {{0ms, kLocal, kRun, ""}, {5s, kPlc, kRun, "local holds the lease"}}, "local"},
        LeaseCase{"OwnCommandsRenew",
                  {{0ms, kPlc, kRun, ""},
                   {9s, kPlc, kNone, ""},
                   {18s, kMqtt, kNone, "modbus 192.0.2.7 holds the lease, for another 1.0 s"},
                   {18999ms, kPanel, kRun, "modbus 192.0.2.7 holds the lease"}},
                  "modbus 192.0.2.7"},
        LeaseCase{
            "RefusedCommandsRenewNothing",
            {{0ms, kPlc, kRun, ""}, {9s, kMqtt, kRun, "modbus"}, {10s, kMqtt, kRun, ""}, {19s, kPlc, kRun, "mqtt"}},
            "mqtt"},
        LeaseCase{"FreeAfterSilence", {{0ms, kPlc, kRun, ""}, {10s, kLocal, kRun, ""}}, "local"},
        LeaseCase{"ForeignStopPassesAndTakesNothing",
                  {{0ms, kPlc, kRun, ""}, {5s, kMqtt, kStop, ""}, {6s, kMqtt, kRun, "modbus 192.0.2.7 holds"}},
                  "modbus 192.0.2.7"},
        LeaseCase{"ForeignStopRenewsNothing",
                  {{0ms, kPlc, kRun, ""}, {9s, kPanel, kStop, ""}, {10s, kPanel, kNone, ""}},
                  "modbus 192.0.2.8"},
        LeaseCase{"HolderMayNotUndoAForeignStop",
                  {{0ms, kPlc, kRun, ""},
                   {1s, kMqtt, kStop, ""},
                   {2s, kPlc, kRun, "stopped by mqtt: modbus 192.0.2.7 has to write a stop value first"},
                   {3s, kPlc, kMomentary, "stopped by mqtt"},
                   {4s, kPlc, kNone, ""},
                   {5s, kPlc, kStop, ""},
                   {6s, kPlc, kRun, ""}},
                  "modbus 192.0.2.7"},
        LeaseCase{"NorWhenHisLeaseIsOver",
                  {{0ms, kPlc, kRun, ""},
                   {1s, kLocal, kStop, ""},
                   {15s, kPlc, kRun, "stopped by local"},
                   {16s, kPanel, kRun, ""},
                   {27s, kPlc, kRun, "stopped by local"},
                   {28s, kPlc, kStop, ""},
                   {29s, kPlc, kRun, ""}},
                  "modbus 192.0.2.7"},
        LeaseCase{"StopOfTheBlockedOneBlocksTheNext",
                  {{0ms, kPlc, kRun, ""},
                   {1s, kMqtt, kStop, ""},
                   {12s, kPanel, kRun, ""},
                   {13s, kPlc, kStop, ""},
                   {14s, kPanel, kRun, "stopped by modbus 192.0.2.7"},
                   {15s, kPlc, kRun, "modbus 192.0.2.8 holds"}},
                  "modbus 192.0.2.8"},
        LeaseCase{"OwnStopBlocksNobody",
                  {{0ms, kPlc, kRun, ""}, {1s, kPlc, kStop, ""}, {2s, kPlc, kRun, ""}},
                  "modbus 192.0.2.7"},
        LeaseCase{"StopTakesAFreeLease", {{0ms, kLocal, kStop, ""}, {1s, kMqtt, kRun, "local holds"}}, "local"}),
    name_of_case);

TEST(Lease, SinceIsWhenItWasTakenNotWhenItWasRenewed) {
  canopen::ManualTime time;
  Lease lease(10s);
  const auto taken = canopen::wall_now();
  lease.on_accepted(kPlc, kRun, canopen::Clock::now());
  time.advance(9s);
  lease.on_accepted(kPlc, kNone, canopen::Clock::now());
  EXPECT_EQ(lease.since(), taken);
  EXPECT_EQ(lease.until(), canopen::Clock::now() + 10s);
  time.advance(10s);
  lease.expire(canopen::Clock::now());
  EXPECT_FALSE(lease.holder());
  EXPECT_EQ(lease.since(), canopen::WallTime{});
  EXPECT_EQ(lease.until(), canopen::kNever);
  lease.on_accepted(kPlc, kRun, canopen::Clock::now());
  EXPECT_EQ(lease.since(), taken + 19s);
}

TEST(Lease, WithoutLengthNobodyHoldsOrIsRefused) {
  canopen::ManualTime time;
  const auto now = canopen::Clock::now();
  Lease lease(0s);
  lease.on_accepted(kPlc, kRun, now);
  lease.on_accepted(kMqtt, kStop, now);
  EXPECT_FALSE(lease.holder());
  EXPECT_EQ(lease.until(), canopen::kNever);
  EXPECT_FALSE(lease.refuse(kPlc, kRun, now));
  EXPECT_FALSE(lease.refuse(kPanel, kRun, now));
}

TEST(Lease, OfVeryManyWhoWereStoppedTheFirstIsForgotten) {
  canopen::ManualTime time;
  Lease lease(1s);
  canopen::TimePoint now = canopen::Clock::now();
  const auto client = [](int i) {
    return Writer{.way = Writer::Way::modbus, .address = "192.0.2." + std::to_string(i)};
  };
  for (int i = 0; i <= 64; ++i, now += 1s) {
    lease.on_accepted(client(i), kRun, now);
    lease.on_accepted(kMqtt, kStop, now);
  }
  EXPECT_FALSE(lease.refuse(client(0), kRun, now));
  EXPECT_TRUE(lease.refuse(client(1), kRun, now));
  EXPECT_TRUE(lease.refuse(client(64), kRun, now));
}

}  // namespace
}  // namespace process
