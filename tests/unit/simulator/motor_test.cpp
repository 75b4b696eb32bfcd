#include "simulator/motor.h"

#include <gtest/gtest.h>

#include <chrono>

namespace simulator {
namespace {

using std::chrono::milliseconds;

void pass(Motor& motor, milliseconds time) {
  for (; time > milliseconds(0); time -= milliseconds(10)) {
    motor.step(milliseconds(10));
  }
}

TEST(Motor, RampsUpHoldsAndRampsDown) {
  Motor motor;
  motor.set_target(30.0);
  EXPECT_EQ(motor.state(), MotorState::stopped);
  pass(motor, milliseconds(1000));
  EXPECT_EQ(motor.output_hz(), 0.0);  // a set-point alone moves nothing

  motor.run(false);
  pass(motor, milliseconds(1000));
  EXPECT_NEAR(motor.output_hz(), 10.0, 1e-6);
  EXPECT_TRUE(motor.accelerating());
  EXPECT_NEAR(motor.shaft_rpm(), 300.0, 1e-6);  // 60 f / 2 pole pairs
  pass(motor, milliseconds(2010));
  EXPECT_DOUBLE_EQ(motor.output_hz(), 30.0);
  pass(motor, milliseconds(10));
  EXPECT_FALSE(motor.accelerating());
  EXPECT_FALSE(motor.decelerating());

  motor.stop();
  pass(motor, milliseconds(1000));
  EXPECT_NEAR(motor.output_hz(), 20.0, 1e-6);
  EXPECT_TRUE(motor.decelerating());
  pass(motor, milliseconds(2010));
  EXPECT_EQ(motor.state(), MotorState::stopped);
  EXPECT_EQ(motor.output_hz(), 0.0);
}

TEST(Motor, TurnsRoundThroughZero) {
  Motor motor;
  motor.set_target(10.0);
  motor.run(false);
  pass(motor, milliseconds(1100));
  motor.run(true);
  pass(motor, milliseconds(500));
  EXPECT_NEAR(motor.output_hz(), 5.0, 1e-6);
  EXPECT_FALSE(motor.reverse());
  EXPECT_TRUE(motor.decelerating());
  pass(motor, milliseconds(1600));
  EXPECT_DOUBLE_EQ(motor.output_hz(), -10.0);
  EXPECT_TRUE(motor.reverse());
  EXPECT_LT(motor.torque_percent(), 0.0);
  EXPECT_NEAR(motor.shaft_rpm(), -300.0, 1e-6);
}

TEST(Motor, CoastingHasNoOutputWhileTheShaftRunsOut) {
  Motor motor;
  motor.set_target(20.0);
  motor.run(false);
  pass(motor, milliseconds(3000));
  motor.coast();
  EXPECT_EQ(motor.output_hz(), 0.0);
  EXPECT_EQ(motor.current_a(), 0.0);
  EXPECT_NEAR(motor.shaft_rpm(), 600.0, 1e-6);
  pass(motor, milliseconds(2000));
  EXPECT_NEAR(motor.shaft_rpm(), 300.0, 1e-6);
  pass(motor, milliseconds(2010));
  EXPECT_EQ(motor.state(), MotorState::stopped);
}

TEST(Motor, QuickStopHasItsOwnRamp) {
  Motor motor;
  motor.set_target(20.0);
  motor.run(false);
  pass(motor, milliseconds(3000));
  motor.stop_quickly(40.0);
  pass(motor, milliseconds(250));
  EXPECT_NEAR(motor.output_hz(), 10.0, 1e-6);
}

TEST(Motor, ReadingsArePlausible) {
  Motor motor;
  const double idle_bus = motor.dc_bus_v();
  EXPECT_NEAR(idle_bus, 311.1, 0.1);
  motor.set_target(50.0);
  motor.run(false);
  pass(motor, milliseconds(100));
  const double starting = motor.torque_percent();
  pass(motor, milliseconds(6000));
  EXPECT_NEAR(motor.torque_percent(), 65.0, 1e-6);
  EXPECT_GT(starting, 30.0);
  EXPECT_NEAR(motor.power_percent(), 65.0, 1e-6);
  EXPECT_DOUBLE_EQ(motor.output_v(), 220.0);
  EXPECT_GT(motor.current_a(), 3.0);
  EXPECT_LT(motor.current_a(), motor.rating().rated_a);
  EXPECT_LT(motor.dc_bus_v(), idle_bus);
  const double warm = motor.temperature_c();
  pass(motor, milliseconds(60000));
  EXPECT_GT(motor.temperature_c(), warm);
  motor.set_target(1000.0);
  EXPECT_DOUBLE_EQ(motor.target_hz(), 50.0);
  motor.set_target(-1.0);
  EXPECT_DOUBLE_EQ(motor.target_hz(), 0.0);
}

TEST(Motor, SwitchedOffItStandsAtOnceAndForgetsItsTarget) {
  Motor motor;
  motor.set_target(50.0);
  motor.run(false);
  pass(motor, milliseconds(1000));
  motor.switch_off();
  EXPECT_EQ(motor.shaft_rpm(), 0.0);
  EXPECT_EQ(motor.state(), MotorState::stopped);
  EXPECT_EQ(motor.target_hz(), 0.0);
}

}  // namespace
}  // namespace simulator
