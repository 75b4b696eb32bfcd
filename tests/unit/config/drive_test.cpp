#include <gmock/gmock.h>

#include <chrono>

#include "tests/unit/config/site.h"

namespace config {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

std::string drive(std::string_view name, int node, std::string_view more = "") {
  return "[[drive]]\nname = \"" + std::string(name) + "\"\nnode = " + std::to_string(node) +
         "\nprofile = \"cia402-velocity\"\n" + std::string(more);
}

TEST(Drives, TakeTheirKeys) {
  const Model model = model_of(kBus + drive("a", 9, R"(unit = "none"
heartbeat = "100ms"
heartbeat_timeout = "300ms"
supervise_gateway = "2s"
on_stale = "hold"
reconfigure_running = true
identity = { vendor = 0x90, revision = 1 }
sdo = { timeout = "1s", retries = 0 }
error_register = false
emcy = { layout = "class-and-vendor40", error_register = false, error_field = false, enable = true }
error_control = { policy = "verify", guarding = true }
setup = [{ object = "0x6060", type = "i8", value = 2 }, { object = "0x6007", type = "i16", value = -1 }]
[drive.commands]
writers = ["mqtt"]
raw = true
nmt_while_running = true
deadline = "2s"
[drive.emcy_texts]
0x8611 = { text = "Lagging", severity = "warning" }
)"));
  const Drive& a = model.drives.at(0);
  EXPECT_EQ(a.unit, std::nullopt);
  EXPECT_EQ(a.node.error_control.heartbeat, milliseconds(100));
  EXPECT_EQ(a.node.error_control.heartbeat_timeout, milliseconds(300));
  EXPECT_EQ(a.node.error_control.supervise_gateway, seconds(2));
  EXPECT_EQ(a.node.error_control.policy, canopen::SetupPolicy::verify);
  EXPECT_TRUE(a.node.error_control.has_guarding);
  EXPECT_EQ(a.on_stale, OnStale::hold);
  EXPECT_TRUE(a.node.reconfigure_running);
  EXPECT_EQ(a.node.identity.vendor, 0x90U);
  EXPECT_EQ(a.node.identity.revision, 1U);
  EXPECT_EQ(a.node.identity.product, std::nullopt);
  EXPECT_EQ(a.node.sdo.timeout, seconds(1));
  EXPECT_EQ(a.node.sdo.retries, 0U);
  EXPECT_EQ(a.node.emcy.layout, canopen::EmcyLayout::class_and_vendor40);
  EXPECT_TRUE(a.node.emcy.enable);
  EXPECT_FALSE(a.faults.has_error_register);
  EXPECT_FALSE(a.faults.error_register_follows);
  EXPECT_FALSE(a.faults.has_error_field);
  ASSERT_EQ(a.node.setup.size(), 2U);
  EXPECT_EQ(a.node.setup[0], (canopen::ObjectValue{{0x6060, 0}, canopen::DataType::i8, 2}));
  EXPECT_EQ(a.node.setup[1].raw, ~canopen::Raw{0});
  EXPECT_EQ(a.commands, (Commands{{false, true, false}, true, true, seconds(2)}));
  EXPECT_EQ(a.faults.emcy_texts.at(0x8611), (FaultText{"Lagging", Severity::warning}));
  EXPECT_EQ(a.faults.emcy_texts.at(0x3210).text, "DC link overvoltage");
}

TEST(Drives, HaveNodesOfTheirOwnAndTheErrorNamesAFreeOne) {
  EXPECT_EQ(error_of(kBus + drive("a", 1) + drive("b", 1, "unit = 7\n")),
            "gateway.toml:9:8: error: drive \"b\": node 1 on bus \"can0\" is that of drive \"a\"; 2 is free");
  EXPECT_EQ(error_of(kBus + drive("a", 127)),
            "gateway.toml:5:8: error: drive \"a\": node 127 on bus \"can0\" is that of the gateway; 1 is free");
  EXPECT_TRUE(load_site(kBus + "node_id = 0\n" + drive("a", 127)).model.has_value());
}

TEST(Drives, HaveUnitsOfTheirOwnAndTheErrorNamesAFreeOne) {
  EXPECT_EQ(error_of(kBus + drive("a", 1) + drive("b", 2, "unit = 1\n")),
            "gateway.toml:11:8: error: drive \"b\": Modbus unit 1 is that of drive \"a\"; 2 is free");
  const std::string two = kBus + "[[bus]]\nname = \"can1\"\n";
  EXPECT_EQ(error_of(two + drive("a", 3, "bus = \"can0\"\n") + drive("b", 3, "bus = \"can1\"\n")),
            "gateway.toml:12:8: error: drive \"b\": Modbus unit 3 (its node id, as no unit is given) is that of drive "
            "\"a\"; 1 is free");
  EXPECT_TRUE(load_site(kBus + drive("a", 1, "unit = \"none\"\n") + drive("b", 2, "unit = 1\n")).model.has_value());
}

TEST(Drives, HaveNamesOfTheirOwnThatAreNoFixedTopics) {
  EXPECT_THAT(error_of(kBus + drive("a", 1) + drive("a", 2)),
              HasSubstr("8:8: error: drive \"a\": there is another drive of this name"));
  for (const auto* const name : {"bus", "status", "info", "result"}) {
    EXPECT_THAT(error_of(kBus + drive(name, 1)),
                HasSubstr("4:8: error: drive \"" + std::string(name) + "\": the name is that of a fixed topic"));
  }
}

TEST(Drives, HaveCobIdsOfTheirOwn) {
  EXPECT_THAT(error_of(kBus + drive("a", 1) + drive("b", 2, "tpdo1 = { cob_id = 0x181 }\n")),
              HasSubstr("11:20: error: drive \"b\": tpdo1 has the COB-ID 0x0181 of tpdo1 of drive \"a\"; give one of "
                        "them another cob_id"));
}

TEST(HeartbeatTimes, MustFitEachOther) {
  EXPECT_THAT(error_of(kBus + drive("a", 1, "heartbeat = \"1500ms\"\n")),
              HasSubstr("7:13: error: drive \"a\": heartbeat_timeout \"1500ms\" must be longer than heartbeat "
                        "\"1500ms\""));
  EXPECT_THAT(error_of(kBus + drive("a", 1, "heartbeat_timeout = \"500ms\"\n")), HasSubstr("must be longer"));
  EXPECT_THAT(error_of(kBus + drive("a", 1, "heartbeat = \"1500us\"\n")), HasSubstr("must be whole milliseconds"));
  EXPECT_THAT(error_of(kBus + drive("a", 1, "heartbeat = \"66s\"\n")), HasSubstr("out of range 0s..65535ms"));
}

TEST(ErrorControl, IsOneOfThree) {
  const auto control_of = [](const std::string& keys) {
    const Loaded loaded = load_site(kBus + drive("a", 1, "error_control = { guarding = true }\n" + keys));
    EXPECT_TRUE(loaded.model.has_value()) << keys << lines(loaded.findings);
    return loaded.model ? loaded.model->drives[0].node.error_control : canopen::ErrorControlSettings();
  };
  using Kind = canopen::ErrorControlKind;
  EXPECT_EQ(canopen::kind_of(control_of("")), Kind::heartbeat);
  EXPECT_EQ(canopen::kind_of(control_of("heartbeat = \"0s\"\n")), Kind::none);
  EXPECT_EQ(canopen::kind_of(control_of("heartbeat = \"0s\"\nguarding = \"400ms\"\n")), Kind::guarding);
  const canopen::ErrorControlSettings alone = control_of("guarding = \"400ms\"\n");
  EXPECT_EQ(canopen::kind_of(alone), Kind::guarding);
  EXPECT_EQ(alone.heartbeat, canopen::Duration::zero());
  EXPECT_EQ(alone.guarding, milliseconds(400));
}

TEST(SupervisionOfTheGateway, ByLifeGuardingNeedsNoHeartbeatOfTheGateway) {
  const std::string guarded = "error_control = { guarding = true }\nguarding = \"500ms\"\nsupervise_gateway = ";
  EXPECT_TRUE(load_site(kBus + "node_id = 0\n" + drive("a", 1, guarded + "\"1s\"\n")).model.has_value());
  EXPECT_THAT(error_of(kBus + drive("a", 1, guarded + "\"500ms\"\n")),
              HasSubstr("supervise_gateway \"500ms\" must be longer than guarding \"500ms\""));
}

TEST(SupervisionOfTheGateway, NeedsAHeartbeatThatIsFasterAndADriveThatListens) {
  const std::string supervised = drive("a", 1, "supervise_gateway = \"500ms\"\n");
  EXPECT_THAT(error_of(kBus + supervised), HasSubstr("must be longer than the heartbeat \"500ms\" of bus \"can0\""));
  EXPECT_THAT(error_of(kBus + "heartbeat = \"0s\"\n" + supervised), HasSubstr("set heartbeat of bus \"can0\""));
  EXPECT_THAT(error_of(kBus + "node_id = 0\n" + supervised), HasSubstr("set node_id of bus \"can0\""));
  EXPECT_TRUE(load_site(kBus + "heartbeat = \"100ms\"\n" + supervised).model.has_value());
  EXPECT_THAT(error_of(kBus + kDrive + "supervise_gateway = \"2s\"\n"),
              HasSubstr("7:21: error: drive \"pump1\": profile \"veichi-ac310\" cannot supervise the gateway"));
  EXPECT_TRUE(
      load_site(kBus + kDrive + "supervise_gateway = \"2s\"\nerror_control = { consumer = true }\n").model.has_value());
}

TEST(Setup, NeverCommands) {
  const auto setup = [](std::string_view item) { return drive("a", 1, "setup = [" + std::string(item) + "]\n"); };
  EXPECT_THAT(error_of(kBus + setup("{ object = \"0x6040\", type = \"u16\", value = 15 }")),
              HasSubstr("setup of 0x6040:00: it is a command, and no command is given at boot"));
  EXPECT_THAT(error_of(kBus + setup("{ object = \"0x6042\", type = \"i16\", value = 100 }")),
              HasSubstr("no command is given at boot"));
  EXPECT_THAT(error_of(kBus + setup("{ object = \"0x6060\", type = \"i8\", value = 200 }")),
              HasSubstr("value 200 does not fit i8"));
  EXPECT_THAT(error_of(kBus + setup("{ object = \"0x6060\", type = \"u8\", value = -1 }")),
              HasSubstr("value -1 does not fit u8"));
  EXPECT_THAT(error_of(kBus + setup("{ object = \"0x6060\", type = \"f32\", value = 2 }")),
              HasSubstr("only integers can be written at boot"));
  EXPECT_THAT(error_of(kBus + setup("{ object = \"0x6060\", value = 2 }")), HasSubstr("setup 1: type is missing"));
}

}  // namespace
}  // namespace config
