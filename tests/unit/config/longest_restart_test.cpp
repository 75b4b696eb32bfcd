// How long the drives bear to be without the gateway, as `check` says it.
#include "config/longest_restart.h"

#include <gtest/gtest.h>

#include "tests/unit/config/site.h"

namespace config {
namespace {

/// A drive that takes commands by its first RPDO, and has a heartbeat consumer and guarding.
const std::string kSupervising =
    "title = \"t\"\n[error_control]\nconsumer = true\nguarding = true\n"
    "[rpdo1]\nsupervised = true\ntransmission_type = 255\nmap = [\"0x6040 u16\"]\n"
    "[signals.control_command]\nobject = \"0x6040\"\ntype = \"u16\"\naccess = \"write\"\nstop = [0]\n";

std::string patient(const std::string& name, int node, const std::string& keys = "") {
  return "[[drive]]\nname = \"" + name + "\"\nnode = " + std::to_string(node) + "\nprofile = \"own\"\n" + keys;
}

std::string line_of(const std::string& drives, const std::string& bus = "") {
  const Loaded loaded = load_site(kBus + bus + drives, kSupervising);
  EXPECT_EQ(errors_of(loaded), std::vector<std::string>{});
  return loaded.model ? longest_restart(loaded) : "";
}

TEST(LongestRestart, HasNoKnownLimitWhereNoDriveSupervises) {
  EXPECT_EQ(line_of(patient("fan1", 5)), "longest restart: no limit is known, since no drive supervises the gateway");
}

TEST(LongestRestart, IsOneHeartbeatShorterThanTheDriveWaits) {
  EXPECT_EQ(line_of(patient("mixer1", 5, "supervise_gateway = \"2s\"\n")),
            "longest restart: 1.5 s, then mixer1 misses it (supervise_gateway 2s)");
  EXPECT_EQ(line_of(patient("mixer1", 5, "supervise_gateway = \"2s\"\n"), "heartbeat = \"100ms\"\n"),
            "longest restart: 1.9 s, then mixer1 misses it (supervise_gateway 2s)");
}

TEST(LongestRestart, IsThatOfTheMostImpatientDrive) {
  const std::string three = patient("mixer1", 5, "supervise_gateway = \"30s\"\n") +
                            patient("mixer2", 6, "supervise_gateway = \"2s\"\n") +
                            patient("mixer3", 7, "supervise_gateway = \"2s\"\n") + patient("fan1", 8);
  EXPECT_EQ(line_of(three),
            "longest restart: 1.5 s, then mixer2 misses it (supervise_gateway 2s); 3 drives supervise the gateway");
}

TEST(LongestRestart, AskedForByGuardingIsARequestShorterThanTheLifeTime) {
  // 0x100D is a whole factor: 4 x 300 ms.
  EXPECT_EQ(line_of(patient("mixer1", 5,
                            "guarding = \"300ms\"\nheartbeat = \"0s\"\nheartbeat_timeout = \"900ms\"\n"
                            "supervise_gateway = \"1s\"\n")),
            "longest restart: 0.9 s, then mixer1 misses it (supervise_gateway 1s, by guarding)");
}

TEST(LongestRestart, DoesNotCountDrivesThatAreOutOfService) {
  EXPECT_EQ(line_of(patient("fan1", 5) + patient("mixer1", 6, "enabled = false\nsupervise_gateway = \"2s\"\n")),
            "longest restart: no limit is known, since no drive supervises the gateway");
}

TEST(LongestRestart, IsNoneWhereADriveTripsWithoutAnRpdoThatNobodyRepeats) {
  const std::string timer = "[drive.rpdo1]\nevent_timer = \"200ms\"\n";
  const std::string commands = "[drive.commands]\nwriters = [\"local\"]\n";
  EXPECT_EQ(
      line_of(patient("mixer1", 5, "supervise_gateway = \"2s\"\n") + patient("fan1", 6, commands + timer)),
      "longest restart: none: fan1 trips without rpdo1 (event_timer 200ms), which a new start repeats only once it "
      "is commanded again; 2 drives supervise the gateway");
  // Never commanded, so never armed; and the timer of a drive that is not known to have it.
  EXPECT_EQ(line_of(patient("fan1", 6, timer)),
            "longest restart: no limit is known, since no drive supervises the gateway");
  EXPECT_EQ(line_of(patient("fan1", 6, commands + timer + "supervised = false\n")),
            "longest restart: no limit is known, since no drive supervises the gateway");
}

}  // namespace
}  // namespace config
