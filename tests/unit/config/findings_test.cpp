#include <gmock/gmock.h>

#include "tests/unit/config/site.h"

namespace config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Findings, AllMistakesComeAtOnceWithLineAndColumn) {
  const Loaded loaded = load_site(R"([gateway]
name = "line 3"

[[bus]]
name = "can0"
bitrat = 250000

[[drive]]
name = "pump1"
node = 300
profile = "veichi-ac310"
heartbeat = 500

[drive.commands]
writers = ["modbus", "mqt"]
)");
  EXPECT_FALSE(loaded.model.has_value());
  EXPECT_THAT(
      errors_of(loaded),
      ElementsAre(
          "gateway.toml:2:8: error: gateway.name \"line 3\" must be 1 to 32 letters, digits, '_' or '-'",
          "gateway.toml:6:1: error: bus \"can0\": unknown key \"bitrat\"; nearest is \"bitrate\"",
          "gateway.toml:10:8: error: drive \"pump1\": node 300 is out of range 1..127",
          "gateway.toml:12:13: error: drive \"pump1\": heartbeat must be a duration with its unit, such as "
          "\"500ms\", not an integer",
          "gateway.toml:15:22: error: drive \"pump1\": commands.writers \"mqt\" is not known; nearest is \"mqtt\""));
}

TEST(Findings, TextThatIsNoTomlIsTheOnlyOne) {
  const Loaded loaded = load_site("[[drive]\nnode = 300\nx = \n");
  EXPECT_FALSE(loaded.model.has_value());
  ASSERT_EQ(loaded.findings.size(), 1U);
  EXPECT_EQ(loaded.findings[0].line, 1U);
}

TEST(Findings, OfAFileThatIsNotThereNameIt) {
  const Loaded loaded = load({.file = "/nowhere/gateway.toml", .profile_dirs = {}, .host_name = "host"});
  EXPECT_EQ(lines(loaded.findings), "/nowhere/gateway.toml: error: cannot be read: no such file\n");
}

TEST(Findings, AnEmptyFileLacksWhatIsRequired) {
  EXPECT_THAT(errors_of(load_site("")),
              ElementsAre("gateway.toml:1:1: error: bus is missing; write at least one [[bus]]",
                          "gateway.toml:1:1: error: drive is missing; write at least one [[drive]]"));
}

TEST(Findings, RequiredKeysAreNamed) {
  EXPECT_THAT(errors_of(load_site("[[bus]]\n[[drive]]\n")),
              ElementsAre("gateway.toml:1:1: error: bus 1: name is missing",
                          "gateway.toml:2:1: error: drive 1: name is missing",
                          "gateway.toml:2:1: error: drive 1: node is missing",
                          "gateway.toml:2:1: error: drive 1: profile is missing"));
}

TEST(Findings, UnknownKeysDeepInsideNameTheNearest) {
  EXPECT_EQ(error_of(kBus + kDrive + "[drive.signals.frequency_command]\nmaximum = 50\n"),
            "gateway.toml:8:1: error: drive \"pump1\": unknown key \"signals.frequency_command.maximum\"; nearest is "
            "\"signals.frequency_command.max\"");
  EXPECT_THAT(error_of(kBus + kDrive + "[drive.tpdo0]\n"), HasSubstr("unknown key \"tpdo0\""));
  EXPECT_THAT(error_of(kBus + kDrive + "[drive.tpdo513]\n"), HasSubstr("unknown key \"tpdo513\""));
}

struct Case {
  const char* text;
  const char* finding;
};

class NotSupported : public testing::TestWithParam<Case> {};

TEST_P(NotSupported, IsAnErrorAndNeverIgnored) {
  const Loaded loaded = load_site(kBus + kDrive + GetParam().text);
  EXPECT_FALSE(loaded.model.has_value());
  EXPECT_THAT(lines(loaded.findings), HasSubstr(GetParam().finding));
  EXPECT_THAT(lines(loaded.findings), HasSubstr("not supported by this version"));
}

INSTANTIATE_TEST_SUITE_P(Keys, NotSupported,
                         testing::Values(Case{"eds = \"pump.eds\"\n", "7:1: error: drive \"pump1\": eds"}));

TEST(NotBuilt, AreTheDefaultsOfWhatIsNotBuiltEither) {
  EXPECT_EQ(errors_of(load_site(kBus + kDrive + "eds = \"\"\n")),
            (std::vector<std::string>{
                "gateway.toml:7:1: error: drive \"pump1\": eds is not supported by this version; leave it out"}));
}

TEST(WrongTypes, AreNamed) {
  EXPECT_EQ(error_of(kBus + kDrive + "unit = \"some\"\n"),
            "gateway.toml:7:8: error: drive \"pump1\": unit \"some\" must be 1..247 or \"none\"");
  EXPECT_EQ(error_of(kBus + kDrive + "reconfigure_running = \"yes\"\n"),
            "gateway.toml:7:23: error: drive \"pump1\": reconfigure_running must be true or false, not a string");
  EXPECT_EQ(error_of(kBus + kDrive + "commands = 3\n"),
            "gateway.toml:7:12: error: drive \"pump1\": commands must be a table, not an integer");
  EXPECT_EQ(error_of(kBus + kDrive + "heartbeat = \"fast\"\n"),
            "gateway.toml:7:13: error: drive \"pump1\": heartbeat \"fast\" is no duration; write a number with us, ms, "
            "s, min or h, such as \"500ms\"");
  EXPECT_THAT(error_of(kBus + kDrive + "heartbeat_timeout = \"2h\"\n"), HasSubstr("out of range 2ms..10min"));
  EXPECT_THAT(error_of("drive = 3\n" + kBus), HasSubstr("drive must be a list, not an integer"));
}

}  // namespace
}  // namespace config
