#include "simulator/console.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class ConsoleTest : public ::testing::Test {
 protected:
  ConsoleTest() {
    EXPECT_TRUE(console.add(veichi.drive()));
    second = make_drive("vacon-opte6", 7, veichi.network);
    EXPECT_TRUE(console.add(*second));
  }
  std::string run(std::string_view line) {
    std::string answer = console.execute(line);
    veichi.loop.settle();
    return answer;
  }

  OneDrive veichi{"veichi-ac300", 5};
  std::unique_ptr<Drive> second;
  Console console;
};

TEST_F(ConsoleTest, FaultsWarningsAndClear) {
  EXPECT_EQ(run("5 fault 0x0005"), "ok");
  EXPECT_EQ(veichi.drive().model().fault(), 5);
  EXPECT_EQ(veichi.take(0x085).size(), 1U);
  EXPECT_EQ(run("5 warning 64"), "ok");
  EXPECT_EQ(veichi.drive().model().warning(), 64);
  EXPECT_EQ(run("  5\tclear "), "ok");
  EXPECT_EQ(veichi.drive().model().fault(), 0);
}

TEST_F(ConsoleTest, PowerAndReboot) {
  EXPECT_EQ(run("7 fault 1"), "error: node 7 has no power; `power on` first");
  EXPECT_EQ(run("7 power on"), "ok");
  EXPECT_EQ(veichi.take(0x707).size(), 1U);
  EXPECT_EQ(run("all reboot 100"), "ok");
  EXPECT_FALSE(second->powered());
  veichi.advance(milliseconds(100));
  EXPECT_TRUE(second->powered());
  EXPECT_EQ(run("5 reboot"), "ok");
  veichi.advance(milliseconds(499));
  EXPECT_FALSE(veichi.drive().powered());
  veichi.advance(milliseconds(1));
  EXPECT_TRUE(veichi.drive().powered());
  EXPECT_EQ(run("5 power off"), "ok");
  EXPECT_FALSE(veichi.drive().powered());
}

TEST_F(ConsoleTest, AnOrderToAllIsCarriedOutForAllOrNone) {
  EXPECT_THAT(run("all fault 1"), StartsWith("error: node 7"));
  EXPECT_EQ(veichi.drive().model().fault(), 0);
}

TEST_F(ConsoleTest, MisbehaviourSwitches) {
  Misbehaviour& misbehaviour = veichi.drive().misbehaviour();
  EXPECT_EQ(run("5 mute on"), "ok");
  EXPECT_TRUE(misbehaviour.mute);
  EXPECT_EQ(run("5 mute off"), "ok");
  EXPECT_FALSE(misbehaviour.mute);
  EXPECT_EQ(run("5 unplug on"), "ok");
  EXPECT_TRUE(misbehaviour.unplugged);
  EXPECT_EQ(run("5 heartbeat off"), "ok");
  EXPECT_TRUE(misbehaviour.heartbeat_stopped);
  EXPECT_EQ(run("5 boot-up off"), "ok");
  EXPECT_TRUE(misbehaviour.boot_up_missing);
  EXPECT_EQ(run("5 sdo-delay 200"), "ok");
  EXPECT_EQ(misbehaviour.sdo_delay, milliseconds(200));
  EXPECT_EQ(run("5 sdo-drop 3"), "ok");
  EXPECT_EQ(misbehaviour.sdo_drops_left, 3U);
  EXPECT_EQ(run("5 sdo-short on"), "ok");
  EXPECT_TRUE(misbehaviour.sdo_short);
  EXPECT_EQ(run("5 sdo-flaw abort 0x08000022 2"), "ok");
  EXPECT_EQ(misbehaviour.sdo_flaw, SdoFlaw::abort);
  EXPECT_EQ(misbehaviour.abort_code, 0x08000022U);
  EXPECT_EQ(misbehaviour.flaws_left, 2U);
  EXPECT_EQ(run("5 sdo-flaw foreign-index"), "ok");
  EXPECT_EQ(misbehaviour.sdo_flaw, SdoFlaw::foreign_index);
  EXPECT_FALSE(misbehaviour.flaws_left.has_value());
  EXPECT_EQ(run("5 pdo-only 0x06010002"), "ok");
  EXPECT_EQ(misbehaviour.pdo_only, 0x06010002U);
  EXPECT_EQ(run("5 pdo-only off"), "ok");
  EXPECT_FALSE(misbehaviour.pdo_only.has_value());
  EXPECT_EQ(run("5 absent 0x2021:0D"), "ok");
  EXPECT_EQ(run("5 absent 0x2030"), "ok");
  ASSERT_EQ(misbehaviour.absent.size(), 2U);
  EXPECT_EQ(misbehaviour.absent[0].index, 0x2021);
  EXPECT_EQ(misbehaviour.absent[0].sub, 0x0D);
  EXPECT_FALSE(misbehaviour.absent[1].sub.has_value());
  EXPECT_EQ(run("5 absent none"), "ok");
  EXPECT_TRUE(misbehaviour.absent.empty());
  for (const char* wrong : {"5 absent x", "5 absent 0x2021:", "5 absent 0x2021:100", "5 absent 0x12345"}) {
    EXPECT_THAT(run(wrong), HasSubstr("absent: an object like 0x2021 or 0x2021:05, or none expected")) << wrong;
  }
  EXPECT_EQ(run("7 power on"), "ok");
  EXPECT_EQ(run("7 emcy-id 0x80000087"), "ok");
  EXPECT_EQ(veichi.read(7, 0x1014, 0), 0x80000087U);
  EXPECT_EQ(run("7 emcy-id normal"), "ok");
  EXPECT_EQ(veichi.read(7, 0x1014, 0), 0x87U);
  EXPECT_THAT(run("7 emcy-id off"), StartsWith("error: "));
  EXPECT_EQ(run("5 local on"), "ok");
  EXPECT_TRUE(misbehaviour.local);
  EXPECT_EQ(run("5 length tpdo 7"), "ok");
  EXPECT_EQ(misbehaviour.tpdo_length, 7);
  EXPECT_EQ(run("5 length tpdo normal"), "ok");
  EXPECT_FALSE(misbehaviour.tpdo_length.has_value());
  EXPECT_EQ(run("5 behave"), "ok");
  EXPECT_FALSE(misbehaviour.unplugged);
  EXPECT_EQ(misbehaviour.sdo_flaw, SdoFlaw::none);
}

TEST_F(ConsoleTest, LeavesOperational) {
  veichi.start();
  EXPECT_EQ(run("5 nmt pre-operational"), "ok");
  EXPECT_EQ(veichi.drive().state(), NmtState::pre_operational);
  EXPECT_EQ(run("5 nmt stopped"), "ok");
  EXPECT_EQ(veichi.drive().state(), NmtState::stopped);
  EXPECT_EQ(run("5 nmt operational"), "ok");
  EXPECT_EQ(veichi.drive().state(), NmtState::operational);
}

TEST_F(ConsoleTest, ShowsOneLine) {
  veichi.start();
  veichi.send(0x205, {1, 0, 0xD0, 0x07, 0, 0});
  veichi.advance(seconds(3));
  const std::string line = run("5 show");
  EXPECT_THAT(line, StartsWith("node=5 kind=veichi-ac300 power=on nmt=operational motor=running direction=forward "
                               "frequency=20.00 target=20.00 rpm=600 "));
  EXPECT_THAT(line, HasSubstr(" fault=0x0000 "));
  EXPECT_THAT(line, HasSubstr(" rpdos=1 "));
  EXPECT_THAT(line, HasSubstr(" nmt_commands=1 "));
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_THAT(run("list"), HasSubstr("\nnode=7 kind=vacon-opte6 power=off nmt=off "));
}

TEST_F(ConsoleTest, BadLinesAreExplainedAndChangeNothing) {
  EXPECT_EQ(run("9 show"), "error: no drive \"9\"; there are 5, 7, or `all`");
  EXPECT_EQ(run("five show"), "error: no drive \"five\"; there are 5, 7, or `all`");
  EXPECT_EQ(run("5"), "error: what to do is missing; `help` lists the verbs");
  EXPECT_EQ(run("5 explode"), "error: a verb expected, not \"explode\"; `help` lists the verbs");
  EXPECT_EQ(run("5 fault"), "error: it goes `NODE fault CODE`");
  EXPECT_EQ(run("5 fault 1 2"), "error: it goes `NODE fault CODE`");
  EXPECT_EQ(run("5 fault 0"), "error: node 5 fault: a code of 1 to 0xFFFF expected, not \"0\"");
  EXPECT_EQ(run("5 fault 0x10000"), "error: node 5 fault: a code of 1 to 0xFFFF expected, not \"0x10000\"");
  EXPECT_EQ(run("5 fault 0x"), "error: node 5 fault: a code of 1 to 0xFFFF expected, not \"0x\"");
  EXPECT_EQ(run("5 fault -1"), "error: node 5 fault: a code of 1 to 0xFFFF expected, not \"-1\"");
  EXPECT_EQ(run("5 mute maybe"), "error: node 5 mute: on or off expected, not \"maybe\"");
  EXPECT_THAT(run("5 nmt bootup"), StartsWith("error: node 5 nmt: operational, pre-operational or stopped expected"));
  EXPECT_THAT(run("5 sdo-flaw rude"), StartsWith("error: node 5 sdo-flaw: none, foreign-index"));
  EXPECT_THAT(run("5 sdo-flaw abort 0xZZ"), HasSubstr("an abort code expected"));
  EXPECT_THAT(run("5 sdo-flaw none 1 2"), HasSubstr("too much after the count"));
  EXPECT_THAT(run("5 length tpdo 9"), HasSubstr("0 to 8 bytes or normal expected"));
  EXPECT_THAT(run("5 length rpdo 8"), HasSubstr("tpdo, sdo, heartbeat or emcy expected"));
  EXPECT_THAT(run("5 sdo-delay soon"), HasSubstr("a delay of 0 to 3600000 ms expected"));
  EXPECT_EQ(veichi.drive().model().fault(), 0);
  EXPECT_FALSE(veichi.drive().misbehaviour().mute);
  EXPECT_EQ(veichi.drive().misbehaviour().sdo_flaw, SdoFlaw::none);
}

TEST_F(ConsoleTest, HelpNamesEveryVerbAndEmptyLinesAnswerNothing) {
  const std::string help = run("help");
  for (const char* verb : {"power",    "reboot",    "fault",   "warning",   "clear",    "nmt",       "mute",
                           "unplug",   "heartbeat", "boot-up", "sdo-delay", "sdo-drop", "sdo-short", "sdo-flaw",
                           "pdo-only", "local",     "absent",  "emcy-id",   "length",   "behave",    "show"}) {
    EXPECT_THAT(help, HasSubstr(std::string("NODE ") + verb));
  }
  EXPECT_EQ(run(""), "");
  EXPECT_EQ(run("   "), "");
  EXPECT_EQ(run("# a remark"), "");
}

TEST_F(ConsoleTest, ANodeCanBeThereOnce) {
  const auto twin = make_drive("veichi-ac310", 5, veichi.network);
  EXPECT_FALSE(console.add(*twin));
}

}  // namespace
}  // namespace simulator
