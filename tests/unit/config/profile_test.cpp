#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "tests/unit/config/site.h"

namespace config {
namespace {

using testing::HasSubstr;

std::string drive(std::string_view profile, std::string_view more = "") {
  return kBus + "[[drive]]\nname = \"a\"\nnode = 1\nprofile = \"" + std::string(profile) + "\"\n" + std::string(more);
}

TEST(Profiles, OfAnUnknownNameAreReportedWithTheNearest) {
  EXPECT_EQ(
      error_of(drive("veichi-ac311")),
      "gateway.toml:6:11: error: drive \"a\": profile \"veichi-ac311\" is not known; nearest is \"veichi-ac310\"");
  ProfileLibrary none({});
  const Loaded loaded = load_text(drive("x"), {.file = "gateway.toml", .profile_dirs = {}, .host_name = "h"}, none);
  EXPECT_THAT(lines(loaded.findings), HasSubstr("no profile was found at all"));
}

TEST(Profiles, AreReportedForEachDriveThatAsksForThem) {
  const Loaded loaded = load_site(drive("nope") + "[[drive]]\nname = \"b\"\nnode = 2\nprofile = \"nope\"\n");
  EXPECT_EQ(errors_of(loaded).size(), 2U) << lines(loaded.findings);
}

TEST(Profiles, HaveFindingsInTheirOwnFile) {
  EXPECT_EQ(error_of(drive("own"), "title = \"t\"\n[signals.status_word]\nobject = \"0x6041\"\ntype = \"u17\"\n"),
            "own.toml:4:8: error: profile \"own\": signals.status_word.type \"u17\" must be one of bool, u8, u16, u32, "
            "u64, i8, i16, i32, i64, f32, f64");
  EXPECT_EQ(error_of(drive("own"), "title = \"t\"\nx ="),
            "own.toml:2:4: error: not TOML: key-value pair: "
            "encountered end-of-file");
  // What a drive says about itself has no place in a profile, and the other way round.
  EXPECT_THAT(error_of(drive("own"), "title = \"t\"\nnode = 5\n"), HasSubstr("unknown key \"node\""));
  EXPECT_THAT(error_of(drive("veichi-ac300", "slots = {}\n")), HasSubstr("unknown key \"slots\""));
}

TEST(Profiles, OfTwoDrivesReportTheirMistakesOnce) {
  const std::string second = "[[drive]]\nname = \"b\"\nnode = 2\nprofile = \"own\"\n";
  const Loaded loaded = load_site(drive("own") + second, "title = \"t\"\nnode = 5\n");
  EXPECT_EQ(errors_of(loaded).size(), 1U) << lines(loaded.findings);
}

TEST(Profiles, OfTheFirstDirectoryWin) {
  const auto site = std::filesystem::path(testing::TempDir()) / "site-profiles";
  std::filesystem::create_directories(site);
  std::ofstream(site / "veichi-ac300.toml") << "title = \"ours\"\n[signals.status_word]\nobject = \"0x1\"\ntype = "
                                               "\"u8\"\n";
  const LoadOptions options{.file = "gateway.toml", .profile_dirs = {site, kProfiles}, .host_name = "h"};
  const Loaded loaded = load_text(drive("veichi-ac300"), options);
  ASSERT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  EXPECT_EQ(loaded.model->drives.at(0).signals.size(), 1U);
  std::filesystem::remove_all(site);
}

TEST(Profiles, CanExtendOneAnotherButNotThemselves) {
  const std::string own =
      "title = \"t\"\nextends = \"cia402-velocity\"\n[signals.actual_velocity]\nunit = \"Hz\"\n"
      "[signals.target_reached]\nenabled = false\n";
  const Drive drive_a = model_of(drive("own"), own).drives.at(0);
  EXPECT_EQ(signal_of(drive_a, "actual_velocity").unit, "Hz");
  EXPECT_EQ(signal_of(drive_a, "target_velocity").unit, "rpm");
  EXPECT_EQ(drive_a.find("target_reached"), std::nullopt);
  EXPECT_THAT(error_of(drive("own"), "title = \"t\"\nextends = \"own\"\n"), HasSubstr("extends itself"));
  EXPECT_THAT(error_of(drive("own"), "title = \"t\"\nextends = \"nope\"\n"),
              HasSubstr("own.toml:2:11: error: profile \"own\": profile \"nope\" is not known"));
}

TEST(Profiles, ThatArePartialAreNoDrive) {
  EXPECT_THAT(error_of(drive("veichi-ac300can1")), HasSubstr("is only a part of others"));
}

const std::string kSlots = R"(title = "t"
[rpdo1]
map = ["0x2000:01 u16", "0x2000:02 u16"]
[slots.settings]
objects = ["0x2000:01", "0x2000:02"]
standard = { 1 = "speed" }
unconfirmed = "chosen in the drive"
[slots.settings.meanings.speed]
type = "u16"
access = "write"
address = 200
[slots.settings.meanings.torque]
type = "i16"
access = "write"
address = 201
[presets.trying]
text = "for the test"
unconfirmed = "nobody tried"
[presets.trying.signals.speed]
values = { 1 = "slow" }
[presets.known]
text = "for the test"
[presets.known.signals.temperature]
object = "0x2003"
type = "i16"
address = 210
)";

TEST(AssignedObjects, MeanWhatTheProfileSaysUntilTheSiteStatesThem) {
  const Loaded loaded = load_site(drive("own"), kSlots);
  ASSERT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  const Drive& a = loaded.model->drives.at(0);
  EXPECT_EQ(signal_of(a, "speed").object, (canopen::ObjectAddress{0x2000, 1}));
  EXPECT_TRUE(signal_of(a, "speed").unconfirmed);
  EXPECT_EQ(a.node.rpdos.at(0).mapping.at(1).use, canopen::FieldUse::unnamed);
  EXPECT_THAT(warnings_of(loaded), testing::ElementsAre("gateway.toml:3:1: warning: drive \"a\": settings are not "
                                                        "stated: chosen in the drive"));
}

TEST(AssignedObjects, MeanWhatTheSiteStates) {
  const Loaded loaded = load_site(drive("own", "settings = { 2 = \"speed\", 1 = \"unused\" }\n"), kSlots);
  ASSERT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  const Drive& a = loaded.model->drives.at(0);
  EXPECT_EQ(signal_of(a, "speed").object, (canopen::ObjectAddress{0x2000, 2}));
  EXPECT_FALSE(signal_of(a, "speed").unconfirmed);
  EXPECT_EQ(a.node.rpdos.at(0).mapping.at(0).use, canopen::FieldUse::unused);
  EXPECT_EQ(a.node.rpdos.at(0).mapping.at(1).use, canopen::FieldUse::commanded);
  EXPECT_TRUE(loaded.findings.empty()) << lines(loaded.findings);
}

TEST(AssignedObjects, AreReportedWhereTheyCannotBe) {
  EXPECT_THAT(error_of(drive("own", "settings = { 3 = \"speed\" }\n"), kSlots),
              HasSubstr("7:14: error: drive \"a\": settings has no number 3; 1..2 are there"));
  EXPECT_THAT(error_of(drive("own", "settings = { 1 = \"sped\" }\n"), kSlots),
              HasSubstr("settings 1 = \"sped\" is not known; nearest is \"speed\""));
  EXPECT_THAT(error_of(drive("own", "settings = { 1 = \"speed\", 2 = \"speed\" }\n"), kSlots),
              HasSubstr("settings 1 and 2 both are \"speed\""));
  EXPECT_THAT(error_of(drive("cia402-velocity", "settings = { 1 = \"speed\" }\n")),
              HasSubstr("profile \"cia402-velocity\" has no settings"));
}

TEST(Presets, AreSwitchedOnByName) {
  const Loaded loaded =
      load_site(drive("own", "presets = [\"trying\", \"known\"]\nsettings = { 1 = \"speed\" }\n"), kSlots);
  ASSERT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  const Drive& a = loaded.model->drives.at(0);
  EXPECT_EQ(signal_of(a, "speed").values.at(1), "slow");
  EXPECT_EQ(signal_of(a, "temperature").modbus.address, 210);
  EXPECT_THAT(warnings_of(loaded), testing::ElementsAre("gateway.toml:7:12: warning: drive \"a\": preset \"trying\" is "
                                                        "unconfirmed: nobody tried"));
  EXPECT_EQ(model_of(drive("own"), kSlots).drives.at(0).find("temperature"), std::nullopt);
}

TEST(Presets, OfAnUnknownNameAreReported) {
  EXPECT_THAT(error_of(drive("own", "presets = [\"tryin\"]\nsettings = { 1 = \"speed\" }\n"), kSlots),
              HasSubstr("7:12: error: drive \"a\": preset \"tryin\" is not known; nearest is \"trying\""));
  EXPECT_THAT(error_of(drive("cia402-velocity", "presets = [\"x\"]\n")), HasSubstr("has no presets"));
  EXPECT_THAT(error_of(drive("own", "presets = [\"known\", \"known\"]\nsettings = { 1 = \"speed\" }\n"), kSlots),
              HasSubstr("stands there twice"));
}

TEST(Layers, MaySpellOneNumberInTwoWays) {
  const Model model = model_of(drive("cia402-velocity", "[drive.emcy_texts]\n34321 = \"Lagging\"\n"));
  const FaultRules& faults = model.drives.at(0).faults;
  EXPECT_EQ(faults.emcy_texts.at(0x8611).text, "Lagging");
  EXPECT_EQ(faults.emcy_texts.at(0x3210).text, "DC link overvoltage");
}

TEST(Layers, OfThreeSpellingsTheUppermostCounts) {
  const std::string own =
      "title = \"t\"\n[presets.p]\ntext = \"t\"\n[presets.p.fault_texts]\n0x1 = \"b\"\n[fault_texts]\n1 = \"a\"\n";
  const Model model = model_of(drive("own", "presets = [\"p\"]\n[drive.fault_texts]\n1 = \"c\"\n"), own);
  EXPECT_EQ(model.drives.at(0).faults.drive_texts.at(1).text, "c");
}

TEST(Layers, GoByTheSchemaAndNotByNames) {
  // A signal may be called like a key that is replaced as a whole.
  const std::string own =
      "title = \"t\"\n[signals.standard]\nobject = \"0x2000:01\"\ntype = \"u16\"\nscale = 0.1\naddress = 200\n";
  const Model model = model_of(drive("own", "[drive.signals.standard]\nunit = \"V\"\n"), own);
  const Signal& signal = signal_of(model.drives.at(0), "standard");
  EXPECT_EQ(signal.unit, "V");
  EXPECT_EQ(signal.scale, 0.1);
}

TEST(EmergencyTexts, FallBackToTheirClass) {
  FaultRules rules;
  rules.emcy_texts = {{0x2000, {"Current", Severity::fault}},
                      {0x2300, {"Output current", Severity::fault}},
                      {0x2310, {"Continuous overcurrent", Severity::fault}}};
  EXPECT_EQ(find_emcy_text(rules, 0x2310)->text, "Continuous overcurrent");
  EXPECT_EQ(find_emcy_text(rules, 0x2311)->text, "Output current");
  EXPECT_EQ(find_emcy_text(rules, 0x2411)->text, "Current");
  EXPECT_EQ(find_emcy_text(rules, 0x3411), nullptr);
}

}  // namespace
}  // namespace config
