#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>

#include <array>

#include "canopen/bus/socketcan/driver.h"
#include "canopen/bus/socketcan/error_frame.h"
#include "canopen/bus/socketcan/interface_state.h"
#include "canopen/bus/socketcan/receive_batch.h"

namespace canopen::socketcan {
namespace {

TEST(KernelFrames, GoThereAndBack) {
  const std::array<std::uint8_t, 3> bytes{1, 2, 3};
  Frame data = make_frame(0x205, bytes);
  EXPECT_EQ(from_kernel(to_kernel(data)), data);
  data.extended = true;
  data.id = 0x1ABCDEF5;
  EXPECT_EQ(from_kernel(to_kernel(data)), data);
  const Frame guarding{.id = 0x705, .size = 1, .remote = true};
  EXPECT_EQ(to_kernel(guarding).can_id, 0x705 | CAN_RTR_FLAG);
  EXPECT_EQ(from_kernel(to_kernel(guarding)), guarding);
}

TEST(KernelFrames, HostileLengthsAreCut) {
  can_frame raw{};
  raw.can_dlc = 15;
  EXPECT_EQ(from_kernel(raw).size, 8);
  EXPECT_EQ(to_kernel({.id = 0xFFFFFFFF, .size = 200}).can_dlc, 8);
  EXPECT_EQ(to_kernel({.id = 0xFFFFFFFF}).can_id, CAN_SFF_MASK) << "no identifier may set a flag";
}

TEST(KernelFrames, AnErrorFrameKeepsItsClassesWithoutFlag) {
  can_frame raw{};
  raw.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF | CAN_ERR_CRTL;
  raw.can_dlc = CAN_ERR_DLC;
  const Frame frame = from_kernel(raw);
  EXPECT_TRUE(frame.error);
  EXPECT_EQ(frame.id, CAN_ERR_BUSOFF | CAN_ERR_CRTL);
}

Frame error_frame(std::uint32_t classes, std::uint8_t status, std::uint8_t transmit, std::uint8_t receive) {
  return {.id = classes, .size = 8, .error = true, .data = {0, status, 0, 0, 0, 0, transmit, receive}};
}

constexpr BusState kActive{BusCondition::error_active, 0, 0};

TEST(ErrorFrames, TellStateAndCounters) {
  EXPECT_EQ(after_error_frame(kActive, error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING, 96, 3)),
            (BusState{BusCondition::warning, 96, 3}));
  EXPECT_EQ(after_error_frame(kActive, error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE, 0, 128)),
            (BusState{BusCondition::passive, 0, 128}));
  EXPECT_EQ(after_error_frame(kActive, error_frame(CAN_ERR_BUSOFF, 0, 0, 0)).condition, BusCondition::bus_off);
}

TEST(ErrorFrames, PassiveOnOneSideAndWarningOnTheOtherIsPassive) {
  const Frame both = error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_PASSIVE, 128, 96);
  EXPECT_EQ(after_error_frame(kActive, both).condition, BusCondition::passive);
}

TEST(ErrorFrames, RecoveryStepByStep) {
  BusState state{BusCondition::bus_off, 255, 100};
  state = after_error_frame(state, error_frame(CAN_ERR_RESTARTED, 0, 0, 0));
  EXPECT_EQ(state, kActive);
  state =
      after_error_frame({BusCondition::passive, 130, 0}, error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING, 127, 0));
  EXPECT_EQ(state, (BusState{BusCondition::warning, 127, 0}));
  state = after_error_frame(state, error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE, 95, 0));
  EXPECT_EQ(state, (BusState{BusCondition::error_active, 95, 0}));
}

TEST(ErrorFrames, OfSomethingElseChangeNothing) {
  const BusState passive{BusCondition::passive, 128, 0};
  EXPECT_EQ(after_error_frame(passive, error_frame(CAN_ERR_ACK, 0, 0, 0)), passive);
  EXPECT_EQ(after_error_frame(passive, error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW, 0, 0)), passive);
}

TEST(ErrorFrames, AMissingAcknowledgementIsToldApart) {
  EXPECT_TRUE(tells_no_acknowledge(error_frame(CAN_ERR_ACK, 0, 0, 0)));
  EXPECT_TRUE(tells_no_acknowledge(error_frame(CAN_ERR_ACK | CAN_ERR_PROT | CAN_ERR_BUSERROR, 0, 0, 0)));
  EXPECT_FALSE(tells_no_acknowledge(error_frame(CAN_ERR_PROT | CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, 128, 0)));
}

TEST(ErrorFrames, ASingleErrorTellsNothingOfTheState) {
  EXPECT_FALSE(tells_more_than_an_error(error_frame(CAN_ERR_PROT | CAN_ERR_BUSERROR, 0, 8, 0)));
  for (const canid_t id : {CAN_ERR_CRTL, CAN_ERR_BUSOFF, CAN_ERR_RESTARTED, CAN_ERR_ACK}) {
    EXPECT_TRUE(tells_more_than_an_error(error_frame(id | CAN_ERR_PROT, 0, 0, 0)));
  }
}

TEST(ErrorFrames, AnOverrunIsToldApart) {
  EXPECT_TRUE(tells_overrun(error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW, 0, 0)));
  EXPECT_FALSE(tells_overrun(error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_OVERFLOW, 0, 0)));
  EXPECT_FALSE(tells_overrun(error_frame(CAN_ERR_PROT, CAN_ERR_CRTL_RX_OVERFLOW, 0, 0)));
}

TEST(Echoes, ProveADepartureByWhatIsKnownOfTheDriver) {
  constexpr auto kByDriver = EchoProves::by_driver;
  EXPECT_EQ(no_departure_notice(kByDriver, true, "gs_usb"), "");
  EXPECT_EQ(no_departure_notice(kByDriver, true, ""), "");
  for (const auto* const driver : {"peak_usb", "mcba_usb", "usb_8dev", "ems_usb"}) {
    EXPECT_NE(no_departure_notice(kByDriver, true, driver).find(driver), std::string::npos) << driver;
  }
  EXPECT_NE(no_departure_notice(kByDriver, false, "vcan").find("IFF_ECHO"), std::string::npos);
}

TEST(Echoes, ProveWhatTheSiteSays) {
  EXPECT_EQ(no_departure_notice(EchoProves::departure, false, "peak_usb"), "");
  EXPECT_NE(no_departure_notice(EchoProves::adapter, true, "gs_usb").find("configured"), std::string::npos);
}

TEST(InterfaceStates, WhatTheDriverDoesNotSayStays) {
  const BusState off{BusCondition::bus_off, 0, 0};
  Interface interface;
  interface.administratively_up = true;
  EXPECT_EQ(state_of(interface, off), off) << "an error frame told it";
  EXPECT_EQ(state_of(interface, kActive), BusState{}) << "the other end is missing";
  interface.carrier = true;
  EXPECT_EQ(state_of(interface, BusState{}), kActive);
  interface.condition = BusCondition::passive;
  interface.counters = Interface::Counters{128, 3};
  EXPECT_EQ(state_of(interface, kActive), (BusState{BusCondition::passive, 128, 3}));
  interface.administratively_up = false;
  EXPECT_EQ(state_of(interface, kActive), BusState{});
}

}  // namespace
}  // namespace canopen::socketcan
