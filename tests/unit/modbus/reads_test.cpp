#include <gtest/gtest.h>

#include <chrono>
#include <utility>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::example_model;
using modbus_test::Site;
using std::chrono::milliseconds;

config::Model with_on_stale(config::OnStale on_stale) {
  config::Model model = example_model();
  model.drives[0].on_stale = on_stale;
  return model;
}

TEST(Reads, RegistersShowTheRawValues) {
  Site site;
  site.bring_up();
  site.send_values(0x1234, 4997, 0);
  EXPECT_EQ(site.ask("03 0000 0003"), "03 06 1234 0000 1385");
  EXPECT_EQ(site.ask("04 0000 0003"), "04 06 1234 0000 1385");
  site.send_values(0x1234, -2, 0);
  EXPECT_EQ(site.ask("03 0002 0001"), "03 02 fffe");
}

TEST(Reads, WideValuesAndThoseOfOnePduComeTogether) {
  Site site;
  site.bring_up();
  site.send_values(0, 0, 0x0001FFFF);
  EXPECT_EQ(site.ask("03 00c8 0002"), "03 04 0001 ffff");
  site.send_values(0, 0, 0x00020000);
  EXPECT_EQ(site.ask("03 00c8 0002"), "03 04 0002 0000");
  EXPECT_EQ(site.ask("03 00c9 0001"), "03 02 0000");  // half of it may be read
}

TEST(Reads, WordOrderLittle) {
  config::Model model = example_model();
  model.modbus->word_order = config::WordOrder::little;
  Site site(model);
  site.bring_up();
  site.send_values(0, 0, 0x00010002);
  EXPECT_EQ(site.ask("03 00c8 0002"), "03 04 0002 0001");
}

TEST(Reads, SmallRealAndFloatValues) {
  Site site;
  site.bring_up();
  site.send_slow_values(-3, 1.5F, 1234);
  EXPECT_EQ(site.ask("03 000a 0001"), "03 02 fffd");
  EXPECT_EQ(site.ask("03 00ca 0004"), "03 08 3fc0 0000 42f6 cccd");  // 1.5, 123.4
}

TEST(Reads, BitsAreDerivedFromTheWord) {
  Site site;
  site.bring_up();
  site.send_values(0x0001, 0, 0);
  EXPECT_EQ(site.ask("01 0000 0008"), "01 01 01");
  EXPECT_EQ(site.ask("02 0000 0008"), "02 01 01");
  site.send_values(0x0008, 0, 0);
  EXPECT_EQ(site.ask("02 0000 0003"), "02 01 04");
  EXPECT_EQ(site.ask("02 0002 0001"), "02 01 01");
}

TEST(Reads, UnusedAddressesReadZeroOthersDoNotExist) {
  Site site;
  site.bring_up();
  EXPECT_EQ(site.ask("03 0003 0007"), "03 0e 0000 0000 0000 0000 0000 0000 0000");
  EXPECT_EQ(site.ask("03 00c7 0001"), "03 02 0000");
  EXPECT_EQ(site.ask("03 00ce 0001"), "83 02");
  EXPECT_EQ(site.ask("03 00c7 0008"), "83 02");
  EXPECT_EQ(site.ask("03 0440 0001"), "03 02 0000");  // 1088
  EXPECT_EQ(site.ask("03 044b 0001"), "03 02 0000");  // 1099
  EXPECT_EQ(site.ask("03 044c 0001"), "83 02");       // 1100
  EXPECT_EQ(site.ask("03 03e7 0002"), "83 02");       // 999
  EXPECT_EQ(site.ask("04 ffff 0001"), "84 02");
  EXPECT_EQ(site.ask("01 00c7 0001"), "01 01 00");
  EXPECT_EQ(site.ask("01 00c7 0002"), "81 02");
}

TEST(Reads, AForeignUnitHasNoPath) {
  Site site;
  site.bring_up();
  EXPECT_EQ(site.ask(site.client(), 6, "03 0000 0001"), "83 0a");
  EXPECT_EQ(site.ask(site.client(), 248, "03 0000 0001"), "83 0a");
  EXPECT_EQ(site.ask(site.client(), 6, "2b 0e 01 00"), "ab 0a");
  EXPECT_EQ(site.ask(site.client(), 6, "06 0064 0001"), "86 0a");
}

TEST(Reads, OtherFunctionsAreRefused) {
  Site site;
  EXPECT_EQ(site.ask("07"), "87 01");
  EXPECT_EQ(site.ask("08 0000 0000"), "88 01");
  EXPECT_EQ(site.ask("11"), "91 01");
  EXPECT_EQ(site.ask("2b 0c 01 00"), "ab 01");
  EXPECT_EQ(site.ask("2b 0f 00 01"), "ab 01");
  EXPECT_EQ(site.ask(site.client(), 0, "2b 0c 01 00"), "ab 01");
  EXPECT_EQ(site.ask("03 0000 0000"), "83 03");
  EXPECT_EQ(site.ask("03 0000 007e"), "83 03");
}

TEST(Reads, ADriveThatNeverCameHasNoValues) {
  Site site;
  EXPECT_EQ(site.ask("03 0000 0001"), "83 0b");
  EXPECT_EQ(site.ask("01 0000 0001"), "81 0b");
  EXPECT_EQ(site.ask("03 0003 0002"), "03 04 0000 0000");  // nothing there that could be out of date
  EXPECT_EQ(site.ask("03 0064 0002"), "03 04 0000 0000");  // commands never make a read fail
  EXPECT_EQ(site.ask("01 000a 0002"), "01 01 00");
  EXPECT_EQ(site.ask("03 03e8 0003"), "03 06 0000 00ff 00ff");
}

TEST(Reads, AValueThatIsOverdueIsRefusedWhileTheRestStaysReadable) {
  Site site;
  site.bring_up();
  site.send_values(1, 100, 5);
  EXPECT_EQ(site.ask("03 0000 0003"), "03 06 0001 0000 0064");
  site.run_without_values(milliseconds(400));
  EXPECT_EQ(site.ask("03 0000 0001"), "83 0b");
  EXPECT_EQ(site.ask("03 0000 000b"), "83 0b");
  EXPECT_EQ(site.ask("03 00c8 0002"), "83 0b");
  EXPECT_EQ(site.ask("01 0000 0001"), "81 0b");
  EXPECT_EQ(site.ask("03 000a 0001"), "03 02 0000");  // of TPDO2, which comes on change only
  EXPECT_EQ(site.ask("03 03e8 0001"),
            "03 02 002b");  // online, operational, a warning (data), configured; not all fresh
  site.send_values(1, 100, 5);
  EXPECT_EQ(site.ask("03 0000 0001"), "03 02 0001");
}

TEST(Reads, HoldKeepsTheLastValue) {
  Site site(with_on_stale(config::OnStale::hold));
  site.bring_up();
  site.send_values(1, 100, 5);
  site.run_without_values(milliseconds(400));
  EXPECT_EQ(site.ask("03 0000 0003"), "03 06 0001 0000 0064");
  EXPECT_EQ(site.ask("01 0000 0001"), "01 01 01");
}

TEST(Reads, ZeroReadsZero) {
  Site site(with_on_stale(config::OnStale::zero));
  site.bring_up();
  site.send_values(1, 100, 5);
  site.send_slow_values(9, 0.0F, 0);
  site.run_without_values(milliseconds(400));
  EXPECT_EQ(site.ask("03 0000 000b"), "03 16 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0009");
  EXPECT_EQ(site.ask("03 00c8 0002"), "03 04 0000 0000");
  EXPECT_EQ(site.ask("01 0000 0001"), "01 01 00");
  site.send_values(1, 100, 5);
  EXPECT_EQ(site.ask("03 0000 0003"), "03 06 0001 0000 0064");
}

TEST(Reads, APolledValueIsTheDrives) {
  Site site;
  site.bring_up();
  site.run(milliseconds(1500));
  EXPECT_EQ(site.ask("03 0134 0001"), "03 02 0007");
}

/// The temperature (register 10) is polled, and bit 3 is true where it is zero.
config::Model with_polled_temperature() {
  config::Model model = example_model();
  config::Signal& temperature = model.drives[0].signals[3];
  temperature.source = {config::SourceKind::sdo, 0};
  temperature.poll = milliseconds(100);
  config::Signal cold = model.drives[0].signals[7];
  cold.name = "cold";
  cold.derived = config::Derived{.from = 3, .mask = 0xFF, .values = {0}};
  cold.modbus.address = 3;
  model.drives[0].signals.push_back(cold);
  return model;
}

TEST(Reads, AnObjectThatTheDriveLacksReadsZeroAndFailsNothing) {
  for (const config::OnStale on_stale : {config::OnStale::exception, config::OnStale::hold, config::OnStale::zero}) {
    config::Model model = with_polled_temperature();
    model.drives[0].on_stale = on_stale;
    Site site(model);
    site.bring_up();
    site.run(milliseconds(1500));
    ASSERT_EQ(site.ask("02 0003 0001"), "02 01 01");
    site.puppet().dictionary.erase(model.drives[0].signals[3].object);
    site.run(milliseconds(300));
    EXPECT_EQ(site.ask("03 0000 000d"), "03 1a 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000");
    EXPECT_EQ(site.ask("03 000a 0001"), "03 02 0000");
    EXPECT_EQ(site.ask("02 0000 0008"), "02 01 00");
    EXPECT_EQ(site.ask("01 0003 0001"), "01 01 00");
  }
}

TEST(Reads, BesideAnObjectThatTheDriveLacksOthersStillGoStale) {
  Site site(with_polled_temperature());
  site.puppet().dictionary.erase(example_model().drives[0].signals[3].object);
  site.bring_up();
  site.run(milliseconds(1500));
  EXPECT_EQ(site.ask("03 0000 0003"), "03 06 0000 0000 0000");
  site.run_without_values(milliseconds(400));
  EXPECT_EQ(site.ask("03 0000 0003"), "83 0b");
  EXPECT_EQ(site.ask("03 000a 0001"), "03 02 0000");
}

TEST(Reads, DiagnosticsDoNotWaitForAnObjectThatTheDriveLacks) {
  Site site(with_polled_temperature());
  site.puppet().dictionary.erase(example_model().drives[0].signals[3].object);
  site.bring_up();
  site.run(milliseconds(1500));
  // Online, operational, a warning, all values fresh, configured.
  EXPECT_EQ(site.ask("03 03e8 0001"), "03 02 003b");
  EXPECT_EQ(site.ask("03 0410 0001"), "03 02 0005");
  const std::string age = site.ask("03 03f1 0001");
  ASSERT_EQ(age.size(), 10U) << age;
  EXPECT_LT(std::stoul(age.substr(6), nullptr, 16), 3000U) << "that of TPDO2, which came once";
}

}  // namespace
