#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/process/drive_bench.h"

namespace process {

/// Commands to a scripted drive, and what of them reached the bus.
class CommandsTest : public DriveBench {
 protected:
  using DataType = canopen::DataType;
  using ErrorKind = canopen::ErrorKind;
  using NmtCommand = canopen::NmtCommand;

  void expect_refused(const Outcome& outcome, ErrorKind kind) {
    ASSERT_TRUE(outcome.has_error());
    EXPECT_EQ(outcome.error().kind, kind) << canopen::to_string(outcome.error());
  }
  /// Nothing that commands was sent: no RPDO, no SDO download, no NMT.
  void expect_silence() {
    EXPECT_TRUE(rpdos().empty());
    EXPECT_TRUE(sdo_writes().empty());
    EXPECT_TRUE(slave_.heard_on(0).empty());
  }
  /// A single set-point goes to its own object, and no RPDO with an earlier run command leaves.
  void expect_setpoint_goes_alone() {
    slave_.forget_heard();
    EXPECT_TRUE(write_now({field("frequency_command", 20.0)}).has_value());
    EXPECT_TRUE(rpdos().empty());
    EXPECT_EQ(sdo_writes(), Objects{test::kFrequency});
    EXPECT_EQ(slave_.value(test::kFrequency), 2000U);
  }
  /// A run command is given and waits behind a slow write while a fault comes: it is not sent.
  void run_command_waits_while_a_fault_comes() {
    using namespace std::chrono_literals;
    show(test::kRunningBit);
    slave_.delay_answers(100ms);
    const auto slow = write({field("upper_limit", Raw{4000})});
    const auto run_command =
        write({field("control_command", Raw{1}), field("frequency_command", 10.0), field("torque_command", 0.0)});
    run(20ms);
    emcy(0x0004, 0x01);
    ASSERT_TRUE(finish(slow, 300ms).has_value());
    expect_refused(finish(run_command, 300ms), ErrorKind::voided);
    slave_.delay_answers(0ms);
    EXPECT_TRUE(rpdos().empty());
    EXPECT_EQ(sdo_writes(), Objects{test::kLimit});
  }
  void expect_setpoint_rides_on_rpdo() {
    slave_.forget_heard();
    EXPECT_TRUE(write_now({field("frequency_command", 20.0)}).has_value());
    EXPECT_EQ(rpdos(), std::vector<Bytes>({{1, 0, 0xD0, 0x07, 0, 0}}));
    EXPECT_TRUE(sdo_writes().empty());
  }
};

}  // namespace process
