#include "bridges/trace/words.h"

#include <gmock/gmock.h>
#include <linux/can/error.h>

#include <string>

#include "tests/unit/trace/site.h"

namespace trace {
namespace {

using test::Listener;
using testing::HasSubstr;

TEST(TraceWords, NmtCommands) {
  Listener bus;
  EXPECT_EQ(bus.words("000#0105"), "pump1 NMT: start: pump1 (node 5)");
  EXPECT_EQ(bus.words("000#8100"), "all NMT: reset-node: all nodes");
  EXPECT_EQ(bus.words("000#0263"), "node 99 NMT: stop: node 99");
  EXPECT_EQ(bus.words("000#0705"), "pump1 NMT: unknown command 0x07: pump1 (node 5)");
  EXPECT_EQ(bus.words("000#01"), "all NMT: no command: 01");
}

TEST(TraceWords, HeartbeatsAndGuarding) {
  Listener bus;
  EXPECT_EQ(bus.words("705#00"), "pump1 heartbeat: boot-up");
  EXPECT_EQ(bus.words("705#7F"), "pump1 heartbeat: pre-operational");
  EXPECT_EQ(bus.words("77F#05"), "gateway heartbeat: operational");
  EXPECT_EQ(bus.words("709#04"), "node 9 heartbeat: stopped");
  EXPECT_EQ(bus.words("705#07"), "pump1 heartbeat: unknown state 7");
  EXPECT_EQ(bus.words("705#"), "pump1 heartbeat: no data");
  EXPECT_EQ(bus.words("705#R1"), "pump1 guarding: asked for its state (guarding)");
  EXPECT_EQ(bus.words("705#05"), "pump1 guarding: operational (answer to guarding, toggle 0)");
  EXPECT_EQ(bus.words("705#R"), "pump1 guarding: asked for its state (guarding)");
  EXPECT_EQ(bus.words("705#85"), "pump1 guarding: operational (answer to guarding, toggle 1)");
  EXPECT_EQ(bus.words("705#05"), "pump1 heartbeat: operational") << "nobody asked";
  (void)bus.words("705#R1");
  EXPECT_EQ(bus.words("705#00"), "pump1 heartbeat: boot-up") << "of a drive that was away while it was asked";
  EXPECT_EQ(bus.words("705#7F"), "pump1 heartbeat: pre-operational");
}

TEST(TraceWords, SyncAndWhatElseThereIs) {
  Listener bus;
  EXPECT_EQ(bus.words("080#"), "SYNC");
  EXPECT_EQ(bus.words("080#07"), "SYNC: counter 7");
  EXPECT_EQ(bus.words("100#0102030405"), "TIME: 01 02 03 04 05");
  EXPECT_EQ(bus.words("7E5#0400000000000000"), "LSS: 04 00 00 00 00 00 00 00");
  EXPECT_EQ(bus.words("00000185#01"), "other: 29-bit identifier, no CANopen: 01");
  EXPECT_EQ(bus.words("6FF#01"), "other: 01");
}

TEST(TraceWords, EmergenciesByTheTableOfTheirDrive) {
  Listener bus;
  EXPECT_THAT(bus.words("085#0500010500000000"),
              "pump1 EMCY: 0x0005 fault: Overcurrent during acceleration; error register 0x01 (generic error), vendor "
              "bytes 05 00 00 00 00");
  EXPECT_THAT(bus.words("084#0010010500000000"), HasSubstr("mixer1 EMCY: 0x1000 fault: "));
  EXPECT_THAT(bus.words("084#0000000200000000"), HasSubstr("mixer1 EMCY: 0x0000, an error is over, 2 remain; "));
  EXPECT_THAT(
      bus.words("089#1023020000000000"),
      "node 9 EMCY: 0x2310 fault: emergency 0x2310; error register 0x02 (current), vendor bytes 00 00 00 00 00");
  EXPECT_EQ(bus.words("085#05"), "pump1 EMCY: no emergency message: 05");
  Listener other(1);
  EXPECT_THAT(other.words("086#1023020000000000"), HasSubstr("winder1 EMCY: 0x2310 fault: "));
}

// Of each system, by the layouts and scales of its profile.
TEST(TraceWords, PdosInEngineeringUnits) {
  Listener bus;
  EXPECT_EQ(bus.words("185#8513270685130E00"),
            "pump1 TPDO1: status_word 0x1385 (running, ready, decelerating), output_current 157.5 A, output_frequency "
            "49.97 Hz, motor_speed 14 rpm");
  EXPECT_EQ(bus.words("282#851327060700"), "fan1 TPDO2: output_power 499.7 %, input_voltage 157.5 V, fault_code 7 (" +
                                               bus.model().drives.at(0).faults.drive_texts.at(7).text + ")");
  EXPECT_EQ(bus.words("285#851327060000"), "pump1 TPDO2: output_power 499.7 %, input_voltage 157.5 V, fault_code 0");
  EXPECT_EQ(
      bus.words("382#8513270601003200"),
      "fan1 TPDO3: output_torque 499.7 %, dc_bus_voltage 157.5 V, output_voltage 0.1 V, module_temperature 5.0 °C");
  EXPECT_EQ(bus.words("202#0100881301FF"),
            "fan1 RPDO1: control_command forward (1), frequency_command 50.00 Hz, torque_command -25.5 %");
  EXPECT_EQ(
      bus.words("205#0100881301FF0E00"),
      "pump1 RPDO1: control_command 0x0001, frequency_command 50.00 Hz, torque_command -25.5 %; beyond its mapping "
      "0E 00");
  EXPECT_EQ(bus.words("283#8513881388130B14"),
            "hoist1 TPDO2: status_word 0x1385 (warning, ready), output_frequency 50.00 Hz, set_frequency 50.00 Hz, "
            "dc_bus_voltage 513.1 V");
  EXPECT_EQ(
      bus.words("184#3706DC05"),
      "mixer1 TPDO1: status_word 0x0637 (running, ready, remote, target_reached, voltage_enabled), actual_velocity "
      "1500 rpm");
  EXPECT_EQ(bus.words("204#0F0024FA"), "mixer1 RPDO1: control_command 0x000F, target_velocity -1500 rpm");
  EXPECT_EQ(bus.words("484#00"), "mixer1 TPDO4: 00 (not configured)");
  EXPECT_EQ(bus.words("189#0102"), "node 9 TPDO1: 01 02");
  EXPECT_EQ(bus.words("185#R8"), "pump1 TPDO1: asked for");
  EXPECT_EQ(bus.words("185#01"), "pump1 TPDO1: too short, 1 of 8 bytes: 01");
}

TEST(TraceWords, ErrorFrames) {
  Listener bus;
  EXPECT_EQ(bus.words("20000020#0000000000000000"), "error: nobody acknowledged a frame of ours");
  EXPECT_EQ(bus.words("20000040#0000000000000000"), "error: bus-off");
  EXPECT_EQ(bus.words("20000100#0000000000000000"), "error: the controller was restarted");
  EXPECT_EQ(bus.words("20000204#0004000000006000"),
            "error: warning level of receive errors reached, errors counted: 96 sending, 0 receiving");
  EXPECT_EQ(
      bus.words("20000004#0030000000008088"),
      "error: error-passive by receive errors, error-passive by transmit errors, errors counted: 128 sending, 136 "
      "receiving");
  EXPECT_EQ(bus.words("2000008C#0000040000000000"), "error: bus error, trouble of the controller, bit stuffing error");
  EXPECT_EQ(bus.words("20000002#0500000000000000"), "error: arbitration lost at bit 5");
  EXPECT_EQ(bus.words("20000000#0000000000000000"), "error: error frame: 00 00 00 00 00 00 00 00");
  const canopen::Frame frame{.id = CAN_ERR_TRX | CAN_ERR_TX_TIMEOUT, .size = 8, .error = true, .data = {}};
  EXPECT_EQ(error_words(frame), "a frame did not leave in time, trouble of the transceiver or the wiring");
}

TEST(TraceWords, ALineForTheTerminalMarksOurOwnFrames) {
  Listener bus;
  const Line own = line_of(bus.model(), bus.hear("605#4017100000000000", canopen::FrameOrigin::ourselves));
  EXPECT_EQ(own.time, "2026-01-02T03:04:05.678123Z");
  EXPECT_EQ(terminal_line(own),
            "03:04:05.678123 can0 >605 pump1      SDO       read 0x1017:00 producer heartbeat time");
  EXPECT_EQ(terminal_line(line_of(bus.model(), bus.hear("705#05"))),
            "03:04:05.678123 can0  705 pump1      heartbeat operational");
  EXPECT_EQ(terminal_line(line_of(bus.model(), bus.hear("20000040#"))),
            "03:04:05.678123 can0 !               error     bus-off");
  const Entry lost = bus.decoder().lose(3, canopen::WallTime{});
  EXPECT_EQ(line_of(bus.model(), lost).text,
            "at least 3 frames were lost here, in the controller or between it and the gateway");
  EXPECT_EQ(line_of(bus.model(), bus.decoder().lose(1, canopen::WallTime{})).text,
            "at least 1 frame was lost here, in the controller or between it and the gateway")
      << "an overrun of the controller is one frame at least";
  std::string json;
  text::ObjectText object(json);
  append_members(object, own);
  object.close();
  EXPECT_EQ(
      json,
      R"({"ts":"2026-01-02T03:04:05.678123Z","bus":"can0","frame":"605#4017100000000000","own":true,"kind":"sdo",)"
      R"("owner":"pump1","name":"SDO","text":"read 0x1017:00 producer heartbeat time"})");
}

}  // namespace
}  // namespace trace
