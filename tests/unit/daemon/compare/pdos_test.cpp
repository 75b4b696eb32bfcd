// What `check --live` says of PDOs that differ.

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/unit/daemon/compare/live_comparison.h"

namespace gateway::compare {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

TEST_F(LiveDifference, OfTheCommunicationOfAPdo) {
  canopen::PdoSettings& tpdo = node(kMixer).tpdos.front();
  tpdo.cob_id = 0x199;
  tpdo.transmission_type = 1;
  tpdo.event_timer = 1000;
  tpdo.inhibit_time = 2000;
  EXPECT_THAT(
      findings(),
      ElementsAre(
          StartsWith("drive \"mixer1\": error: 0x1800:01 TPDO1 COB-ID: expected 0x199, found 0x"),
          StartsWith(
              "drive \"mixer1\": error: 0x1800:02 TPDO1 transmission type: expected 1, found 255; the gateway writes"),
          StartsWith(
              "drive \"mixer1\": error: 0x1800:03 TPDO1 inhibit time: expected 2000, found 100; the gateway writes"),
          StartsWith(
              "drive \"mixer1\": error: 0x1800:05 TPDO1 event timer: expected 1000, found 100; the gateway writes")));
}

TEST_F(LiveDifference, OfTheMappingOfAPdo) {
  auto& mapping = node(kMixer).rpdos.front().mapping;
  std::swap(mapping[0], mapping[1]);
  EXPECT_THAT(findings(), ElementsAre(StartsWith("drive \"mixer1\": error: 0x1600 RPDO1 mapping: expected 0x6042:00 16 "
                                                 "bit, 0x6040:00 16 bit, found 0x6040:00 16 bit, 0x6042:00 16 bit; "
                                                 "the gateway writes it when it configures the drive")));
}

TEST_F(LiveDifference, OfAMappingThatIsOnlyCompared) {
  node(kMixer).tpdos.front().mapping_policy = canopen::SetupPolicy::verify;
  node(kMixer).tpdos.front().mapping.pop_back();
  EXPECT_THAT(findings(), ElementsAre(AllOf(StartsWith("drive \"mixer1\": error: 0x1A00 TPDO1 mapping: expected "
                                                       "0x6041:00 16 bit, found 0x6041:00 16 bit, 0x6044:00 16 bit"),
                                            HasSubstr("; the gateway only compares it: change it in the drive"))));
}

TEST_F(LiveDifference, OfAMappingThatIsTakenForGranted) {
  node(kHoist).tpdos.front().mapping.front().object = {0x2000, 0x09};
  EXPECT_THAT(findings(), ElementsAre(AllOf(StartsWith("drive \"hoist1\": warning: 0x1A01 TPDO2 mapping: expected "
                                                       "0x2000:09 16 bit, "),
                                            HasSubstr("the gateway takes it for granted as configured"))));
}

TEST_F(LiveDifference, OfAMappingThatTheDriveDoesNotHave) {
  drives_[kMixer]->misbehaviour().absent = {{0x1A00, {}}};
  const std::string same =
      "0x1A00:00 TPDO1 mapping: the drive does not have it, so what this PDO holds is not known; where the manual "
      "tells it, `mapping = \"assume\"`";
  EXPECT_THAT(findings(), ElementsAre("drive \"mixer1\": error: " + same)) << "before the boot that will say so";
  boot_again(kMixer);
  const std::vector<std::string> found = findings();
  ASSERT_THAT(found, Contains("drive \"mixer1\": error: " + same));
  EXPECT_EQ(found.front(), "drive \"mixer1\": error: boot J: " + same);
}

TEST_F(LiveDifference, OfAPdoThatTheDriveDoesNotHave) {
  drives_[kMixer]->misbehaviour().absent = {{0x1800, {}}};
  EXPECT_THAT(findings(), ElementsAre(HasSubstr("error: 0x1A00:00 TPDO1 mapping: the drive does not have it")));
  node(kMixer).tpdos.front().mapping_policy = canopen::SetupPolicy::verify;
  EXPECT_THAT(findings(), IsEmpty()) << "what is documented is taken for granted";
}

TEST_F(LiveDifference, OfAnEventTimerThatSomebodyReliesOn) {
  drives_[kMixer]->misbehaviour().absent = {{0x1400, 5}};
  canopen::PdoSettings& rpdo = node(kMixer).rpdos.front();
  rpdo.event_timer = 500;
  rpdo.event_timer_required = false;
  EXPECT_THAT(findings(), IsEmpty());
  rpdo.event_timer_required = true;
  EXPECT_THAT(findings(), ElementsAre("drive \"mixer1\": error: 0x1400:05 RPDO1 event timer: the drive does not have "
                                      "it, so it would not notice that commands cease"));
}

TEST_F(LiveDifference, OfAMappedObjectThatIsCountedAndNotThere) {
  drives_[kMixer]->misbehaviour().absent = {{0x1A00, 2}};
  EXPECT_THAT(findings(), ElementsAre("drive \"mixer1\": error: 0x1A00:02 TPDO1 mapping: the drive does "
                                      "not have it, although sub 0 says 2"));
}

TEST_F(LiveDifference, OfAMultiplexedPdo) {
  const auto running = read_running(ask(R"({"op":"status"})").value());
  const Comparison comparison =
      compare(configured_, notes_, running.value(), [this](const std::string& request) -> std::optional<std::string> {
        if (request.find(R"("mixer1","object":"0x1A00:00")") != std::string::npos) {
          return R"({"id":1,"ok":true,"value":254})";
        }
        return ask(request);
      });
  ASSERT_THAT(comparison.findings, SizeIs(1));
  EXPECT_THAT(to_string(comparison.findings.front()),
              HasSubstr("error: 0x1A00 TPDO1 mapping: expected 0x6041:00 16 bit, 0x6044:00 16 bit, found 254 objects "
                        "(254 and 255: multiplexed); the gateway writes it"));
}

}  // namespace
}  // namespace gateway::compare
