// What a folder of cases cannot hold: links, directories in place of files, files without content, a bare machine.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "config/load.h"

namespace config {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

constexpr std::string_view kSite = R"([[bus]]
name = "can0"
[[drive]]
name = "pump1"
node = 5
profile = "cia402-velocity"
)";

/// In an empty folder of its own, with a site that is good; the directory before is restored.
class FilesTest : public testing::Test {
 protected:
  FilesTest()
      : before_(fs::current_path()),
        folder_(fs::path(testing::TempDir()) / ("gateway-files-test-" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "profiles");
    fs::current_path(folder_);
    write("gateway.toml", kSite);
  }
  ~FilesTest() override {
    fs::current_path(before_);
    fs::remove_all(folder_);
  }

  static void write(const fs::path& file, std::string_view text) { std::ofstream(file, std::ios::binary) << text; }

  static std::vector<std::string> findings(const LoadOptions& options) {
    std::vector<std::string> lines;
    const Loaded loaded = load(options);
    for (const Finding& finding : loaded.findings) {
      lines.push_back(to_string(finding));
    }
    EXPECT_EQ(loaded.model.has_value(), !has_errors(loaded.findings));
    return lines;
  }
  /// With the site's profiles in `profiles`, and the shipped ones behind them.
  static std::vector<std::string> findings(const fs::path& file = "gateway.toml") {
    return findings(
        {.file = file, .profile_dirs = {"profiles", GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = "host"});
  }

 private:
  fs::path before_;
  fs::path folder_;
};

TEST_F(FilesTest, AreGood) {
  EXPECT_THAT(findings(), ElementsAre());
}

TEST_F(FilesTest, SiteThatCannotBeReadIsTheOnlyFinding) {
  EXPECT_THAT(findings("gatway.toml"), ElementsAre("gatway.toml: error: cannot be read: no such file"));
  EXPECT_THAT(findings("profiles"), ElementsAre("profiles: error: cannot be read: not a file but a directory"));
  EXPECT_THAT(findings("/dev/null"), ElementsAre("/dev/null: error: cannot be read: not a file but a device or pipe"));
  fs::create_symlink("nowhere.toml", "link.toml");
  EXPECT_THAT(findings("link.toml"), ElementsAre("link.toml: error: cannot be read: the link leads nowhere"));
  write("large.toml", std::string((std::size_t{1} << 20U) + 1, '#'));
  EXPECT_THAT(findings("large.toml"), ElementsAre("large.toml: error: cannot be read: larger than 1 MiB"));
  EXPECT_THAT(findings("gateway.toml/gateway.toml"),
              ElementsAre("gateway.toml/gateway.toml: error: cannot be read: Not a directory"));
}

TEST_F(FilesTest, ProfileOfTheSiteIsNeverPassedOverForTheShippedOne) {
  const fs::path own = "profiles/cia402-velocity.toml";
  const std::string begin =
      "gateway.toml:6:11: error: drive \"pump1\": profile \"cia402-velocity\" cannot be read from ";
  fs::create_symlink("nowhere.toml", own);
  EXPECT_THAT(findings(), ElementsAre(begin + own.string() + ": the link leads nowhere"));
  fs::remove(own);
  fs::create_symlink("cia402-velocity.toml", own);
  EXPECT_THAT(findings(), ElementsAre(begin + own.string() + ": Too many levels of symbolic links"));
  fs::remove(own);
  fs::create_directory(own);
  EXPECT_THAT(findings(), ElementsAre(begin + own.string() + ": not a file but a directory"));
}

TEST_F(FilesTest, DirectoryOfProfilesThatCannotBeSearchedIsTold) {
  const std::string begin =
      "gateway.toml:6:11: error: drive \"pump1\": profile \"cia402-velocity\" cannot be read from ";
  fs::remove("profiles");
  fs::create_symlink("profiles", "profiles");
  EXPECT_THAT(findings(), ElementsAre(begin + "profiles/cia402-velocity.toml: Too many levels of symbolic links"));
  fs::remove("profiles");
  write("profiles", "");
  EXPECT_THAT(findings(), ElementsAre(begin + "profiles/cia402-velocity.toml: Not a directory"));
  fs::remove("profiles");
  fs::create_symlink("nowhere", "profiles");
  EXPECT_THAT(findings(),
              ElementsAre(begin + "profiles/cia402-velocity.toml: its directory is a link that leads nowhere"))
      << "a share that is not mounted";
  fs::remove("profiles");
  EXPECT_THAT(findings(), ElementsAre()) << "most sites have no profiles of their own";
}

TEST_F(FilesTest, ProfileThatIsNowhereIsToldWithThoseThatAre) {
  const std::string begin = "gateway.toml:6:11: error: drive \"pump1\": profile \"cia402-velocity\" is not known; ";
  const auto found = [](const std::vector<fs::path>& directories) {
    return findings({.file = "gateway.toml", .profile_dirs = directories, .host_name = "host"});
  };
  EXPECT_THAT(found({"profiles"}), ElementsAre(begin + "no profile was found at all, see --profile-dir"));
  write("profiles/pump.toml", "title = \"Pump\"\n");
  write("profiles/fan.toml", "title = \"Fan\"\n");
  EXPECT_THAT(found({"profiles"}), ElementsAre(begin + "there are fan, pump"));
}

TEST_F(FilesTest, FileOfThePasswordMustHaveOne) {
  const std::string mqtt = std::string(kSite) + "[mqtt]\nusername = \"gateway\"\npassword_file = \"";
  write("empty", "");
  fs::permissions("empty", fs::perms::owner_read);
  write("gateway.toml", mqtt + "empty\"\n");
  EXPECT_THAT(findings(), ElementsAre("gateway.toml:9:17: error: mqtt.password_file \"empty\" is empty; its first line "
                                      "is the password"));
  write("secret", "secret\n");
  fs::permissions("secret", fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
  write("gateway.toml", mqtt + "secret\"\n");
  EXPECT_THAT(findings(), ElementsAre("gateway.toml:9:17: warning: mqtt.password_file \"secret\" can be read by "
                                      "everybody on this machine; chmod o-r it"));
  write("blank", "\nsecret\n");
  fs::permissions("blank", fs::perms::owner_read);
  write("gateway.toml", mqtt + "blank\"\n");
  EXPECT_THAT(findings(), ElementsAre()) << "check reads no secret";
  EXPECT_THAT(findings({.file = "gateway.toml",
                        .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"},
                        .host_name = "host",
                        .with_secrets = true}),
              ElementsAre("gateway.toml:9:17: error: mqtt.password_file \"blank\" begins with an empty line; its first "
                          "line is the password"));
}

TEST_F(FilesTest, MachineWithoutANameNeedsOneInTheFile) {
  EXPECT_THAT(
      findings({.file = "gateway.toml", .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = ""}),
      ElementsAre("gateway.toml:1:1: error: the host's name is no name for a gateway; write [gateway] name = "
                  "\"…\""));
}

}  // namespace
}  // namespace config
