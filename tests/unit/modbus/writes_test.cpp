#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <string>
#include <vector>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::example_model;
using modbus_test::frame;
using modbus_test::kAccelerationObject;
using modbus_test::kControlObject;
using modbus_test::kFrequencyObject;
using modbus_test::kJogObject;
using modbus_test::kLimitObject;
using modbus_test::kRelayObject;
using modbus_test::kTargetObject;
using modbus_test::kUnit;
using modbus_test::kValveObject;
using modbus_test::Site;
using modbus_test::TcpClient;
using std::chrono::milliseconds;
using support::Puppet;

std::vector<canopen::ObjectAddress> written_objects(const Puppet& puppet) {
  std::vector<canopen::ObjectAddress> objects;
  for (const canopen::ObjectValue& value : puppet.written) {
    objects.push_back(value.object);
  }
  return objects;
}

bool nothing_sent(const Puppet& puppet) {
  return puppet.written.empty() && puppet.rpdos.empty();
}

class Writes : public testing::Test {
 protected:
  Writes() {
    site_.bring_up();
    puppet().written.clear();
  }
  Puppet& puppet() { return site_.puppet(); }
  std::string ask(std::string_view pdu) { return site_.ask(pdu); }

  Site site_;
};

TEST_F(Writes, AParameterGoesBySdoAndReadsBackWhatWasConfirmed) {
  EXPECT_EQ(ask("06 012c 1388"), "06 012c 1388");
  ASSERT_EQ(puppet().written.size(), 1U);
  EXPECT_EQ(puppet().written[0].object, kAccelerationObject);
  EXPECT_EQ(puppet().written[0].raw, 0x1388U);
  EXPECT_EQ(ask("03 012c 0001"), "03 02 1388");
}

TEST_F(Writes, Function16CompletesAnRpdoAndThenOneRegisterIsEnough) {
  EXPECT_EQ(ask("10 0064 0002 04 0003 1388"), "10 0064 0002");
  ASSERT_EQ(puppet().rpdos.size(), 1U);
  EXPECT_EQ(puppet().rpdos[0].data[0], 0x03);
  EXPECT_EQ(puppet().rpdos[0].data[2], 0x88);
  EXPECT_EQ(puppet().rpdos[0].data[3], 0x13);
  EXPECT_EQ(ask("03 0064 0002"), "03 04 0003 1388");
  EXPECT_EQ(ask("06 0065 0064"), "06 0065 0064");
  ASSERT_EQ(puppet().rpdos.size(), 2U);
  EXPECT_EQ(puppet().rpdos[1].data[0], 0x03);
  EXPECT_EQ(puppet().rpdos[1].data[2], 0x64);
  EXPECT_TRUE(puppet().written.empty());
}

TEST_F(Writes, RegistersThatTheDriveLacksTakeAZeroBesideTheControlCommand) {
  EXPECT_EQ(ask("10 0064 0004 08 0003 1388 0000 0000"), "10 0064 0004");
  ASSERT_EQ(puppet().rpdos.size(), 1U);
  EXPECT_EQ(puppet().rpdos[0].data[0], 0x03);
  EXPECT_EQ(ask("17 0064 0004 0064 0004 08 0005 1388 0000 0000"), "17 08 0005 1388 0000 0000");
  EXPECT_EQ(puppet().rpdos.size(), 2U);
  EXPECT_EQ(ask("10 0064 0004 08 0003 1388 0000 0001"), "90 02");
  EXPECT_EQ(ask("10 0065 0002 04 1388 0000"), "90 02");
  EXPECT_EQ(ask("06 0066 0000"), "86 02");
  EXPECT_EQ(puppet().rpdos.size(), 2U);
  EXPECT_TRUE(puppet().written.empty());
}

TEST_F(Writes, WideValuesAreWrittenWhole) {
  EXPECT_EQ(ask("10 012e 0002 04 ffff fffe"), "10 012e 0002");
  ASSERT_EQ(puppet().written.size(), 1U);
  EXPECT_EQ(puppet().written[0].object, kTargetObject);
  EXPECT_EQ(puppet().written[0].raw, 0xFFFFFFFEU);
  EXPECT_EQ(ask("06 012e 0001"), "86 02");
  EXPECT_EQ(ask("06 012f 0001"), "86 02");
  EXPECT_EQ(ask("10 012f 0002 04 0001 0001"), "90 02");
  EXPECT_EQ(ask("16 012e ffff 0000"), "96 02");
  EXPECT_EQ(puppet().written.size(), 1U);
}

TEST_F(Writes, FloatsAreEngineeringUnits) {
  EXPECT_EQ(ask("10 0130 0002 04 4247 e148"), "10 0130 0002");  // 49.97, the limit itself
  ASSERT_EQ(puppet().written.size(), 1U);
  EXPECT_EQ(puppet().written[0].object, kLimitObject);
  EXPECT_EQ(puppet().written[0].raw, 4997U);
  EXPECT_EQ(ask("10 0130 0002 04 4247 eb85"), "90 03");  // 49.98
  EXPECT_EQ(ask("10 0130 0002 04 7fc0 0000"), "90 03");  // NaN
  EXPECT_EQ(ask("10 0130 0002 04 7f80 0000"), "90 03");  // infinity
  EXPECT_EQ(puppet().written.size(), 1U);
}

TEST_F(Writes, OutOfRangeIsRefusedNotClamped) {
  EXPECT_EQ(ask("06 0065 1389"), "86 03");  // 50.01 Hz
  EXPECT_EQ(ask("10 0064 0002 04 0003 1389"), "90 03");
  EXPECT_EQ(ask("06 0132 0080"), "86 03");  // 128 in an INTEGER8
  EXPECT_TRUE(nothing_sent(puppet()));
  EXPECT_EQ(ask("06 0132 ff80"), "06 0132 ff80");
  EXPECT_EQ(puppet().written[0].object, kJogObject);
  EXPECT_EQ(puppet().written[0].raw, 0x80U);
}

// A drive whose jog speed, an INTEGER8, stands beside the command; 5 stops it.
config::Model with_narrow_neighbour() {
  config::Model model = example_model();
  model.drives[0].node.motor.stops = {{0xFFFF, 5}};
  for (config::Signal& signal : model.drives[0].signals) {
    if (signal.object == kJogObject) {
      signal.modbus.address = 102;
    }
  }
  return model;
}

TEST(WritesBesideAStop, WhatTheTypeCanNotHoldIsNotSentAndTheStopIs) {
  Site site(with_narrow_neighbour());
  site.bring_up();
  site.puppet().written.clear();
  EXPECT_EQ(site.ask("10 0064 0003 06 0005 0000 012c"), "90 03");
  ASSERT_EQ(site.puppet().rpdos.size(), 1U);
  EXPECT_EQ(site.puppet().rpdos[0].data[0], 5);
  EXPECT_TRUE(site.puppet().written.empty());
  EXPECT_EQ(site.ask("03 0064 0003"), "03 06 0005 0000 0000");
}

TEST(WritesBesideAStop, WithoutAStopNothingIsSent) {
  Site site(with_narrow_neighbour());
  site.bring_up();
  site.puppet().written.clear();
  EXPECT_EQ(site.ask("10 0064 0003 06 0003 0000 012c"), "90 03");
  EXPECT_EQ(site.ask("10 0064 0003 06 0105 0000 012c"), "90 03") << "0x0105 is no stop";
  EXPECT_TRUE(nothing_sent(site.puppet()));
}

TEST_F(Writes, WhatTakesNoValueIsNoAddress) {
  for (const char* const pdu : {"06 0000 0001", "06 0001 0001", "06 0066 0001", "06 00ce 0001", "06 ffff 0001"}) {
    EXPECT_EQ(ask(pdu), "86 02") << pdu;
  }
  EXPECT_EQ(ask("10 0064 0003 06 0001 0001 0001"), "90 02");
  EXPECT_EQ(ask("05 0000 ff00"), "85 02");
  EXPECT_EQ(ask("0f 000a 0003 01 07"), "8f 02");
  EXPECT_EQ(ask("16 0000 0000 0001"), "96 02");
  EXPECT_TRUE(nothing_sent(puppet()));
}

TEST_F(Writes, CoilsAreWrittenOneOrMany) {
  EXPECT_EQ(ask("05 000a ff00"), "05 000a ff00");
  EXPECT_EQ(ask("0f 000a 0002 01 02"), "0f 000a 0002");
  const std::vector<canopen::ObjectAddress> expected{kRelayObject, kRelayObject, kValveObject};
  EXPECT_EQ(written_objects(puppet()), expected);
  EXPECT_EQ(puppet().written[0].raw, 1U);
  EXPECT_EQ(puppet().written[1].raw, 0U);
  EXPECT_EQ(puppet().written[2].raw, 1U);
  EXPECT_EQ(ask("01 000a 0002"), "01 01 02");
}

TEST_F(Writes, ARefusalOfTheDriveIsADeviceFailure) {
  puppet().refuse_writes[kAccelerationObject] = 0x08000022;
  EXPECT_EQ(ask("06 012c 0001"), "86 04");
  EXPECT_EQ(ask("03 012c 0001"), "03 02 0000");  // only a confirmation changes the table
}

TEST_F(Writes, NoConfirmationInTimeIsNoResponse) {
  puppet().mute = true;
  const auto request = frame(kUnit, "06 012c 0001");
  TcpClient& client = site_.client();
  ASSERT_EQ(client.send(request), request.size());
  site_.loop().advance(milliseconds(450));
  client.receive();
  EXPECT_FALSE(client.has_frame());
  site_.loop().advance(milliseconds(400));
  EXPECT_EQ(site_.answer(client), "86 0b");
}

TEST_F(Writes, AWaitingWriteHoldsOnlyThatClient) {
  puppet().mute = true;
  const auto request = frame(kUnit, "06 012c 0001");
  const auto behind = frame(kUnit, "03 03f2 0001", 2);
  TcpClient& waiting = site_.client();
  ASSERT_EQ(waiting.send(request), request.size());
  ASSERT_EQ(waiting.send(behind), behind.size());
  site_.settle();
  TcpClient other(site_.port());
  EXPECT_EQ(site_.ask(other, kUnit, "03 0064 0001"), "03 02 0000");
  waiting.receive();
  EXPECT_FALSE(waiting.has_frame());
  site_.loop().advance(milliseconds(850));
  EXPECT_EQ(site_.answer(waiting), "86 0b");
  EXPECT_EQ(site_.answer(waiting), "03 02 0001");
}

TEST_F(Writes, AClientMayReadForLongBeforeItWrites) {
  for (int second = 0; second < 60; ++second) {
    EXPECT_EQ(ask("03 03e9 0001"), "03 02 0005");
    site_.run(std::chrono::seconds(1));
  }
  EXPECT_EQ(ask("06 012c 1388"), "06 012c 1388");
  EXPECT_EQ(puppet().written.size(), 1U);
}

TEST_F(Writes, AClientThatLeavesDuringItsWriteDoesNoHarm) {
  puppet().mute = true;
  const auto request = frame(kUnit, "06 012c 0001");
  {
    TcpClient leaving(site_.port());
    ASSERT_EQ(leaving.send(request), request.size());
    site_.settle();
  }
  site_.loop().advance(milliseconds(900));
  EXPECT_EQ(site_.server().clients(), 0U);
  EXPECT_EQ(ask("03 0064 0001"), "03 02 0000");
}

TEST_F(Writes, NothingIsSentToADriveThatIsLost) {
  puppet().mute = true;
  site_.loop().advance(milliseconds(2000), milliseconds(10));
  EXPECT_EQ(ask("06 012c 0001"), "86 0b");
  EXPECT_EQ(ask("10 0064 0002 04 0001 0001"), "90 0b");
  puppet().mute = false;
  EXPECT_TRUE(nothing_sent(puppet()));
}

TEST_F(Writes, Function23WritesThenReads) {
  EXPECT_EQ(ask("17 0064 0002 0064 0002 04 0003 1388"), "17 04 0003 1388");
  EXPECT_EQ(puppet().rpdos.size(), 1U);
}

TEST_F(Writes, Function23ChecksBothPartsBeforeAnythingIsSent) {
  EXPECT_EQ(ask("17 00ce 0001 012c 0001 02 0001"), "97 02");
  EXPECT_EQ(ask("17 0000 0001 0066 0001 02 0001"), "97 02");
  site_.run_without_values(milliseconds(400));
  EXPECT_EQ(ask("17 0000 0001 012c 0001 02 0001"), "97 0b");
  EXPECT_TRUE(nothing_sent(puppet()));
}

TEST_F(Writes, NmtCommandsGoThroughTheirRegister) {
  puppet().nmt_commands.clear();
  EXPECT_EQ(ask("06 03fc 0002"), "06 03fc 0002");
  EXPECT_EQ(puppet().nmt_commands, std::vector<std::uint8_t>{2});
  EXPECT_EQ(ask("03 03fc 0001"), "03 02 0002");
  EXPECT_EQ(ask("06 03fc 0003"), "86 03");
  EXPECT_EQ(ask("06 03fc 0102"), "86 03");
  EXPECT_EQ(ask("16 03fc ff00 0001"), "96 03");
  EXPECT_EQ(puppet().nmt_commands.size(), 1U);
  EXPECT_EQ(ask("10 03fc 0001 02 0001"), "10 03fc 0001");
  EXPECT_EQ(puppet().nmt_commands.back(), 1);
  EXPECT_EQ(ask("03 03fc 0001"), "03 02 0001");
}

TEST_F(Writes, NmtStopIsForbiddenWhileTheMotorRuns) {
  puppet().nmt_commands.clear();
  site_.send_values(0x0001, 0, 0);
  EXPECT_EQ(ask("06 03fc 0002"), "86 01");
  EXPECT_EQ(ask("06 03fc 0081"), "86 01");
  EXPECT_TRUE(puppet().nmt_commands.empty());
  EXPECT_EQ(ask("03 03fc 0001"), "03 02 0000");
}

TEST(WritePermission, OnlyFromTheNetworksThatMayWrite) {
  config::Model model = example_model();
  model.modbus->write_from = {{"192.0.2.0", 24}};
  Site site(model);
  site.bring_up();
  site.puppet().written.clear();
  for (const char* const pdu : {"06 012c 0001", "10 012c 0001 02 0001", "16 012c 0000 0001"}) {
    const std::string answer = site.ask(pdu);
    EXPECT_EQ(answer.substr(2), " 01") << pdu;
  }
  EXPECT_EQ(site.ask("17 0064 0001 012c 0001 02 0001"), "97 01");
  EXPECT_EQ(site.ask("05 000a ff00"), "85 01");
  EXPECT_EQ(site.ask("0f 000a 0001 01 01"), "8f 01");
  EXPECT_EQ(site.ask("06 03fc 0001"), "86 01");
  EXPECT_EQ(site.ask("03 0064 0001"), "03 02 0000");
  EXPECT_TRUE(nothing_sent(site.puppet()));
}

TEST(WritePermission, OnlyWhereTheDriveNamesModbusAsWriter) {
  config::Model model = example_model();
  model.drives[0].commands.writers.modbus = false;
  Site site(model);
  site.bring_up();
  site.puppet().written.clear();
  site.puppet().nmt_commands.clear();
  EXPECT_EQ(site.ask("06 012c 0001"), "86 01");
  EXPECT_EQ(site.ask("06 03fc 0080"), "86 01");
  EXPECT_TRUE(nothing_sent(site.puppet()));
  EXPECT_TRUE(site.puppet().nmt_commands.empty());
}

}  // namespace
