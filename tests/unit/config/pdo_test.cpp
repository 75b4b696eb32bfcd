#include <gmock/gmock.h>

#include <chrono>

#include "tests/unit/config/site.h"

namespace config {
namespace {

using canopen::FieldUse;
using canopen::SetupPolicy;
using std::chrono::milliseconds;
using testing::HasSubstr;

const std::string kThreeObjects = R"(title = "a drive of the test"
[tpdo1]
map = ["0x2000:01 u16"]
[rpdo1]
map = ["0x2001:01 u16", "0x2001:02 i16", "0x0005 u8"]
[signals.status_word]
object = "0x2000:01"
type = "u16"
[signals.control_command]
object = "0x2001:01"
type = "u16"
access = "write"
[signals.target_velocity]
object = "0x2001:02"
type = "i16"
access = "write"
)";

std::string pdo_site(std::string_view more, std::string_view bus = "") {
  return kBus + std::string(bus) + "[[drive]]\nname = \"a\"\nnode = 1\nprofile = \"own\"\n" + std::string(more);
}

canopen::NodeSettings node_with(std::string_view more, std::string_view bus = "") {
  return model_of(pdo_site(more, bus), kThreeObjects).drives.at(0).node;
}

std::string pdo_error_with(std::string_view more) {
  return error_of(pdo_site(more), kThreeObjects);
}

TEST(Pdos, HaveThePredefinedCobIds) {
  const auto node = node_with("");
  EXPECT_EQ(node.tpdos.at(0).cob_id, 0x181U);
  EXPECT_EQ(node.rpdos.at(0).cob_id, 0x201U);
  EXPECT_EQ(node.tpdos.at(0).communication, SetupPolicy::write);
  EXPECT_EQ(node.tpdos.at(0).mapping_policy, SetupPolicy::write);
  EXPECT_EQ(node.tpdos.at(0).transmission_type, std::nullopt);
}

TEST(Pdos, CountOnAnEventTimerThatTheSiteStatesOrTheDriveIsKnownToHave) {
  const auto required = [](std::string_view more, std::string_view profile = "") {
    return model_of(pdo_site(more), kThreeObjects + std::string(profile))
        .drives.at(0)
        .node.rpdos.at(0)
        .event_timer_required;
  };
  EXPECT_FALSE(required(""));
  EXPECT_TRUE(required("rpdo1.event_timer = \"300ms\"\n"));
  EXPECT_FALSE(required("rpdo1.event_timer = \"0s\"\n")) << "none needs no object";
  const std::string timed = "[rpdo2]\nmap = [\"0x2002:01 u16\"]\nevent_timer = \"300ms\"\n";
  const std::string signal = "[signals.x]\nobject = \"0x2002:01\"\ntype = \"u16\"\naccess = \"write\"\naddress = 200\n";
  const auto second = [&](std::string_view more, std::string_view profile) {
    return model_of(pdo_site(more), kThreeObjects + timed + std::string(profile) + signal)
        .drives.at(0)
        .node.rpdos.at(1)
        .event_timer_required;
  };
  EXPECT_FALSE(second("", ""));
  EXPECT_TRUE(second("", "supervised = true\n"));
  EXPECT_TRUE(second("rpdo2.event_timer = \"300ms\"\n", "")) << "the same value, but the site's";
  EXPECT_FALSE(node_with("tpdo1.event_timer = \"300ms\"\n").tpdos.at(0).event_timer_required);
}

TEST(Pdos, TakeTheirKeys) {
  const auto node = node_with(
      "tpdo1 = { cob_id = \"$NODEID+0x380\", communication = \"assume\", mapping = \"verify\", "
      "transmission_type = 254, inhibit_time = \"5ms\", event_timer = \"200ms\" }\n");
  const canopen::PdoSettings& tpdo = node.tpdos.at(0);
  EXPECT_EQ(tpdo.cob_id, 0x381U);
  EXPECT_EQ(tpdo.communication, SetupPolicy::assume);
  EXPECT_EQ(tpdo.mapping_policy, SetupPolicy::verify);
  EXPECT_EQ(tpdo.transmission_type, 254);
  EXPECT_EQ(tpdo.inhibit_time, 50);
  EXPECT_EQ(tpdo.event_timer, 200);
  EXPECT_EQ(tpdo.period, milliseconds(200));
  EXPECT_EQ(node_with("inhibit_unit = \"1ms\"\ntpdo1 = { inhibit_time = \"5ms\" }\n").tpdos.at(0).inhibit_time, 5);
}

TEST(Pdos, KnowTheirPeriod) {
  const std::string sync = "sync = \"20ms\"\n";
  const auto period = [&sync](std::string_view keys) {
    return node_with("tpdo1 = { " + std::string(keys) + " }\n", sync).tpdos.at(0).period;
  };
  EXPECT_EQ(period("transmission_type = 5"), milliseconds(100));
  EXPECT_EQ(period("transmission_type = 1"), milliseconds(20));
  EXPECT_EQ(period("transmission_type = 0"), canopen::Duration::zero());
  EXPECT_EQ(period("transmission_type = 255"), canopen::Duration::zero());
  EXPECT_EQ(period("transmission_type = 255, event_timer = \"100ms\""), milliseconds(100));
  EXPECT_EQ(period("event_timer = \"0s\""), canopen::Duration::zero());
}

TEST(Pdos, RefuseWhatCannotWork) {
  EXPECT_THAT(pdo_error_with("tpdo1 = { transmission_type = 1 }\n"),
              HasSubstr("tpdo1: transmission type 1 needs SYNC; set sync of bus \"can0\""));
  EXPECT_THAT(pdo_error_with("tpdo1 = { transmission_type = 252 }\n"), HasSubstr("use 0..240, 254 or 255"));
  EXPECT_THAT(pdo_error_with("tpdo1 = { cob_id = 0x601 }\n"), HasSubstr("COB-ID 0x0601 is reserved by CiA 301"));
  EXPECT_THAT(pdo_error_with("tpdo1 = { cob_id = 0x80 }\n"), HasSubstr("is reserved"));
  EXPECT_THAT(pdo_error_with("tpdo1 = { cob_id = 0x201 }\n"), HasSubstr("rpdo1 has the COB-ID 0x0201 of tpdo1"));
  EXPECT_THAT(pdo_error_with("tpdo1 = { inhibit_time = \"50us\" }\n"), HasSubstr("must be a multiple of 100us"));
  EXPECT_THAT(pdo_error_with("tpdo1 = { event_timer = \"1500us\" }\n"), HasSubstr("must be a multiple of 1ms"));
  EXPECT_THAT(pdo_error_with("tpdo1 = { unused = [\"status_word\"] }\n"), HasSubstr("unused is for RPDOs"));
  EXPECT_THAT(pdo_error_with("tpdo5 = { map = [\"0x2000:09 u16\"] }\n"), HasSubstr("tpdo5: cob_id is missing"));
  EXPECT_THAT(pdo_error_with("tpdo2 = { map = [] }\n"), HasSubstr("tpdo2: map is missing"));
  EXPECT_THAT(pdo_error_with("tpdo2 = { map = [\"0x2000:09\"] }\n"), HasSubstr("tpdo2.map"));
}

TEST(Rpdos, HaveAnEventTimerThatCanBeKept) {
  EXPECT_THAT(pdo_error_with("rpdo1 = { event_timer = \"5ms\" }\n"), HasSubstr("shorter than an RPDO can be repeated"));
  EXPECT_THAT(lines(load_site(pdo_site("rpdo1 = { event_timer = \"9ms\" }\n"), kThreeObjects).findings),
              HasSubstr("7:25: warning: drive \"a\": rpdo1: event_timer \"9ms\" is below twice"));
}

TEST(Pdos, MapNoObjectTwice) {
  EXPECT_THAT(pdo_error_with("tpdo1 = { map = [\"0x2000:01 u16\", \"0x2000:01 u16\"] }\n"),
              HasSubstr("7:17: error: drive \"a\": tpdo1: map names 0x2000:01 twice"));
}

TEST(Pdos, HoldSixtyFourBits) {
  EXPECT_THAT(
      pdo_error_with("tpdo1 = { map = [\"0x2000:01 u16\", \"0x2000:02 u32\", \"0x2000:03 u16\", \"0x2000:04 bool\"] "
                     "}\n"),
      HasSubstr("7:17: error: drive \"a\": tpdo1: map has 65 bits; a PDO holds 64"));
}

TEST(Pdos, MapAnObjectWithTheLengthOfItsSignal) {
  EXPECT_THAT(pdo_error_with("tpdo1 = { map = [\"0x2000:01 u32\"] }\n"),
              HasSubstr("signal \"status_word\" is u16, but tpdo1 maps its object with 32 bits"));
}

TEST(Pdos, ServeSignalsTheRightWayRound) {
  EXPECT_THAT(pdo_error_with("[drive.signals.status_word]\nsource = \"tpdo2\"\n"),
              HasSubstr("has the source \"tpdo2\", which does not map 0x2000:01"));
  EXPECT_THAT(pdo_error_with("[drive.signals.status_word]\naccess = \"write\"\nsource = \"tpdo1\"\n"),
              HasSubstr("comes in tpdo1, so access must be"));
  EXPECT_THAT(pdo_error_with("[drive.signals.target_velocity]\naccess = \"read-write\"\n"),
              HasSubstr("is mapped in rpdo1, which cannot be read back"));
  EXPECT_THAT(
      pdo_error_with("[drive.signals.second]\nobject = \"0x2001:02\"\ntype = \"i16\"\naccess = \"write\"\naddress = "
                     "300\n"),
      HasSubstr("writes 0x2001:02, as \""));
}

TEST(RpdoFields, AreCommandedUnusedOrUnnamed) {
  const auto uses = [](const canopen::NodeSettings& node) {
    std::vector<FieldUse> list;
    for (const canopen::MappedObject& field : node.rpdos.at(0).mapping) {
      list.push_back(field.use);
    }
    return list;
  };
  EXPECT_THAT(uses(node_with("")), testing::ElementsAre(FieldUse::commanded, FieldUse::commanded, FieldUse::unused));
  EXPECT_THAT(uses(node_with("rpdo1 = { unused = [\"target_velocity\"] }\n")),
              testing::ElementsAre(FieldUse::commanded, FieldUse::unused, FieldUse::unused));
  EXPECT_THAT(uses(node_with("rpdo1 = { unused = [\"0x2001:02\"] }\n")),
              testing::ElementsAre(FieldUse::commanded, FieldUse::unused, FieldUse::unused));
  EXPECT_THAT(uses(node_with("[drive.signals.target_velocity]\nsource = \"sdo\"\n")),
              testing::ElementsAre(FieldUse::commanded, FieldUse::unnamed, FieldUse::unused));
  EXPECT_THAT(pdo_error_with("rpdo1 = { unused = [\"status_word\"] }\n"),
              HasSubstr("rpdo1: unused \"status_word\" is no field of it"));
}

TEST(RpdoFields, DeclaredUnusedAreNoSignalAnyMore) {
  const Model model = model_of(pdo_site("rpdo1 = { unused = [\"target_velocity\"] }\n"), kThreeObjects);
  EXPECT_EQ(model.drives.at(0).find("target_velocity"), std::nullopt);
}

TEST(Rpdos, NobodyCommandsAreLeftAlone) {
  EXPECT_TRUE(node_with("rpdo1 = { unused = [\"target_velocity\", \"control_command\"] }\n").rpdos.empty());
  const auto node = node_with("rpdo1 = { enabled = false }\n");
  EXPECT_TRUE(node.rpdos.empty());
}

}  // namespace
}  // namespace config
