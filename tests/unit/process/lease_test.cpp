// Who keeps a drive to himself: two Modbus clients, MQTT and the command line against each other.

#include "bridges/process/lease.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "tests/unit/process/control_cases.h"

namespace process {
namespace {

using namespace std::chrono_literals;

/// A command, when it comes, and what the lease says: nothing, or how its refusal begins.
struct LeaseStep {
  std::chrono::milliseconds at;
  Writer writer;
  ControlUse use;
  std::string refusal;
};

struct LeaseCase {
  std::string name;
  std::vector<LeaseStep> steps;
  std::string holder;  ///< After the last step; empty: nobody.
};

class LeaseCases : public testing::TestWithParam<LeaseCase> {
 protected:
  canopen::ManualTime time_;
};

TEST_P(LeaseCases, EachCommandIsTakenOrRefused) {
  Lease lease(10s);
  const canopen::TimePoint start = canopen::Clock::now();
  canopen::TimePoint now = start;
  for (const LeaseStep& step : GetParam().steps) {
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

INSTANTIATE_TEST_SUITE_P(
    Against, LeaseCases,
    testing::Values(
        LeaseCase{"FirstTakesIt", {{0ms, test::kPlc, ControlUse::run, ""}}, "modbus 192.0.2.7"},
        LeaseCase{"OtherModbusClient",
                  {{0ms, test::kPlc, ControlUse::run, ""},
                   {5800ms, test::kPanel, ControlUse::none,
                    "modbus 192.0.2.7 holds the lease, for another 4.2 s unless renewed"}},
                  "modbus 192.0.2.7"},
        LeaseCase{"MqttAgainstModbus",
                  {{0ms, test::kPlc, ControlUse::none, ""},
                   {1ms, test::kMqtt, ControlUse::run, "modbus 192.0.2.7 holds the lease, for another 10.0 s"}},
                  "modbus 192.0.2.7"},
        LeaseCase{"LocalAgainstMqtt",
                  {{0ms, test::kMqtt, ControlUse::run, ""},
                   {9999ms, test::kLocal, ControlUse::run, "mqtt holds the lease, for another 0.1 s"}},
                  "mqtt"},
        LeaseCase{
            "ModbusAgainstLocal",
            {{0ms, test::kLocal, ControlUse::run, ""}, {5s, test::kPlc, ControlUse::run, "local holds the lease"}},
            "local"},
        LeaseCase{"OwnCommandsRenew",
                  {{0ms, test::kPlc, ControlUse::run, ""},
                   {9s, test::kPlc, ControlUse::none, ""},
                   {18s, test::kMqtt, ControlUse::none, "modbus 192.0.2.7 holds the lease, for another 1.0 s"},
                   {18999ms, test::kPanel, ControlUse::run, "modbus 192.0.2.7 holds the lease"}},
                  "modbus 192.0.2.7"},
        LeaseCase{"RefusedCommandsRenewNothing",
                  {{0ms, test::kPlc, ControlUse::run, ""},
                   {9s, test::kMqtt, ControlUse::run, "modbus"},
                   {10s, test::kMqtt, ControlUse::run, ""},
                   {19s, test::kPlc, ControlUse::run, "mqtt"}},
                  "mqtt"},
        LeaseCase{"FreeAfterSilence",
                  {{0ms, test::kPlc, ControlUse::run, ""}, {10s, test::kLocal, ControlUse::run, ""}},
                  "local"},
        LeaseCase{"ForeignStopPassesAndTakesNothing",
                  {{0ms, test::kPlc, ControlUse::run, ""},
                   {5s, test::kMqtt, ControlUse::stop, ""},
                   {6s, test::kMqtt, ControlUse::run, "modbus 192.0.2.7 holds"}},
                  "modbus 192.0.2.7"},
        LeaseCase{"ForeignStopRenewsNothing",
                  {{0ms, test::kPlc, ControlUse::run, ""},
                   {9s, test::kPanel, ControlUse::stop, ""},
                   {10s, test::kPanel, ControlUse::none, ""}},
                  "modbus 192.0.2.8"},
        LeaseCase{
            "HolderMayNotUndoAForeignStop",
            {{0ms, test::kPlc, ControlUse::run, ""},
             {1s, test::kMqtt, ControlUse::stop, ""},
             {2s, test::kPlc, ControlUse::run, "stopped by mqtt: modbus 192.0.2.7 has to write a stop value first"},
             {3s, test::kPlc, ControlUse::momentary, "stopped by mqtt"},
             {4s, test::kPlc, ControlUse::none, ""},
             {5s, test::kPlc, ControlUse::stop, ""},
             {6s, test::kPlc, ControlUse::run, ""}},
            "modbus 192.0.2.7"},
        LeaseCase{"NorWhenHisLeaseIsOver",
                  {{0ms, test::kPlc, ControlUse::run, ""},
                   {1s, test::kLocal, ControlUse::stop, ""},
                   {15s, test::kPlc, ControlUse::run, "stopped by local"},
                   {16s, test::kPanel, ControlUse::run, ""},
                   {27s, test::kPlc, ControlUse::run, "stopped by local"},
                   {28s, test::kPlc, ControlUse::stop, ""},
                   {29s, test::kPlc, ControlUse::run, ""}},
                  "modbus 192.0.2.7"},
        LeaseCase{"StopOfTheBlockedOneBlocksTheNext",
                  {{0ms, test::kPlc, ControlUse::run, ""},
                   {1s, test::kMqtt, ControlUse::stop, ""},
                   {12s, test::kPanel, ControlUse::run, ""},
                   {13s, test::kPlc, ControlUse::stop, ""},
                   {14s, test::kPanel, ControlUse::run, "stopped by modbus 192.0.2.7"},
                   {15s, test::kPlc, ControlUse::run, "modbus 192.0.2.8 holds"}},
                  "modbus 192.0.2.8"},
        LeaseCase{"OwnStopBlocksNobody",
                  {{0ms, test::kPlc, ControlUse::run, ""},
                   {1s, test::kPlc, ControlUse::stop, ""},
                   {2s, test::kPlc, ControlUse::run, ""}},
                  "modbus 192.0.2.7"},
        LeaseCase{"StopTakesAFreeLease",
                  {{0ms, test::kLocal, ControlUse::stop, ""}, {1s, test::kMqtt, ControlUse::run, "local holds"}},
                  "local"}),
    test::row_name<LeaseCase>);

TEST(Lease, SinceIsWhenItWasTakenNotWhenItWasRenewed) {
  canopen::ManualTime time;
  Lease lease(10s);
  const auto taken = canopen::wall_now();
  lease.on_accepted(test::kPlc, ControlUse::run, canopen::Clock::now());
  time.advance(9s);
  lease.on_accepted(test::kPlc, ControlUse::none, canopen::Clock::now());
  EXPECT_EQ(lease.since(), taken);
  EXPECT_EQ(lease.until(), canopen::Clock::now() + 10s);
  time.advance(10s);
  lease.expire(canopen::Clock::now());
  EXPECT_FALSE(lease.holder());
  EXPECT_EQ(lease.since(), canopen::WallTime{});
  EXPECT_EQ(lease.until(), canopen::kNever);
  lease.on_accepted(test::kPlc, ControlUse::run, canopen::Clock::now());
  EXPECT_EQ(lease.since(), taken + 19s);
}

TEST(Lease, WithoutLengthNobodyHoldsOrIsRefused) {
  canopen::ManualTime time;
  const auto now = canopen::Clock::now();
  Lease lease(0s);
  lease.on_accepted(test::kPlc, ControlUse::run, now);
  lease.on_accepted(test::kMqtt, ControlUse::stop, now);
  EXPECT_FALSE(lease.holder());
  EXPECT_EQ(lease.until(), canopen::kNever);
  EXPECT_FALSE(lease.refuse(test::kPlc, ControlUse::run, now));
  EXPECT_FALSE(lease.refuse(test::kPanel, ControlUse::run, now));
}

TEST(Lease, OfVeryManyWhoWereStoppedTheFirstIsForgotten) {
  canopen::ManualTime time;
  Lease lease(1s);
  canopen::TimePoint now = canopen::Clock::now();
  const auto client = [](int i) {
    return Writer{.way = Writer::Way::modbus, .address = "192.0.2." + std::to_string(i)};
  };
  for (int i = 0; i <= 64; ++i, now += 1s) {
    lease.on_accepted(client(i), ControlUse::run, now);
    lease.on_accepted(test::kMqtt, ControlUse::stop, now);
  }
  EXPECT_FALSE(lease.refuse(client(0), ControlUse::run, now));
  EXPECT_TRUE(lease.refuse(client(1), ControlUse::run, now));
  EXPECT_TRUE(lease.refuse(client(64), ControlUse::run, now));
}

}  // namespace
}  // namespace process
