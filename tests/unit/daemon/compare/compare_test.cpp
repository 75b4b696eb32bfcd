// What `check --live` says of the simulated drives of the demo, and of drives and configurations that differ.

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/unit/daemon/compare/live_comparison.h"

namespace gateway::compare {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

TEST_F(LiveComparison, FindsNothingWhereAllIsAsConfigured) {
  const Comparison comparison = look();
  EXPECT_THAT(comparison.findings, IsEmpty());
  EXPECT_EQ(comparison.drives, 4U);
  EXPECT_GT(comparison.objects.alike, 30U);
  EXPECT_EQ(summary(comparison), "live: 4 drives compared, " + std::to_string(comparison.objects.alike) +
                                     " objects as configured, " + std::to_string(comparison.objects.absent) +
                                     " that a drive does not have");
}

TEST_F(LiveComparison, OnlyReads) {
  std::vector<std::uint64_t> writes;
  for (const auto& drive : drives_) {
    writes.push_back(simulator::Record::total(drive->record().sdo_writes));
  }
  look();
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    EXPECT_EQ(simulator::Record::total(drives_[i]->record().sdo_writes), writes[i]) << i;
    EXPECT_TRUE(gateway_.plant().drive(i).status().online) << i;
  }
}

// ---- Differences of each kind: of the drive, or of the configuration beside it.

TEST_F(LiveDifference, OfIdentity) {
  node(kMixer).identity = {.device_type = 0x00010192, .vendor = 0x2F, .product = 0};
  EXPECT_THAT(
      findings(),
      ElementsAre(AllOf(StartsWith("drive \"mixer1\": error: 0x1018:01 vendor: expected 0x2F, found 0x90; it is "
                                   "another device than the configuration says"))));
}

TEST_F(LiveDifference, OfTheHeartbeat) {
  set(kPump, {0x1017, 0}, 0);
  EXPECT_THAT(findings(), Contains(AllOf(StartsWith("drive \"pump1\": error: 0x1017:00 heartbeat time: expected 500, "
                                                    "found 0; the gateway writes it when it configures the drive"),
                                         HasSubstr("`canopen-gateway nmt pump1 reset-communication`"))));
}

TEST_F(LiveDifference, OfAHeartbeatThatWillDo) {
  set(kPump, {0x1017, 0}, 600);
  EXPECT_THAT(findings(), ElementsAre("drive \"pump1\": warning: 0x1017:00 heartbeat time: expected 500, found 600, "
                                      "which will do"));
}

TEST_F(LiveDifference, OfTheSupervisionOfTheGateway) {
  node(kMixer).error_control.supervise_gateway = 5s;
  EXPECT_THAT(findings(), ElementsAre(StartsWith("drive \"mixer1\": error: 0x1016 supervision of the gateway (node "
                                                 "127): expected 5000 ms, found 2000 ms; the gateway writes it")));
}

TEST_F(LiveDifference, OfASupervisionThatNobodyWants) {
  node(kMixer).error_control.supervise_gateway = 0s;
  EXPECT_THAT(findings(), ElementsAre(AllOf(StartsWith("drive \"mixer1\": warning: 0x1016 supervision"),
                                            HasSubstr("none is configured, found 2000 ms: the drive trips"))));
}

TEST_F(LiveDifference, OfASupervisionThatIsNotThere) {
  node(kPump).error_control.supervise_gateway = 2s;
  EXPECT_THAT(findings(), ElementsAre(HasSubstr("\"pump1\": error: 0x1016 supervision of the gateway (node 127): "
                                                "expected 2000 ms, found no entry for it")));
}

TEST_F(LiveDifference, OfGuarding) {
  set(kHoist, {0x100C, 0}, 500);
  set(kHoist, {0x100D, 0}, 3);
  EXPECT_THAT(findings(), ElementsAre(StartsWith("drive \"hoist1\": warning: 0x100C guard time 500 ms and 0x100D life "
                                                 "time factor 3: no guarding is configured")));
}

TEST_F(LiveDifference, OfGuardingThatIsWanted) {
  node(kHoist).error_control = {.heartbeat = 0s,
                                .heartbeat_timeout = 1500ms,
                                .guarding = 500ms,
                                .supervise_gateway = 1500ms,
                                .has_guarding = true};
  EXPECT_THAT(findings(),
              AllOf(Contains(HasSubstr("error: 0x1017:00 heartbeat time: expected 0, found 500")),
                    Contains(HasSubstr("error: 0x100C:00 guard time: expected 500, found 0")),
                    Contains(HasSubstr("error: 0x100D:00 life time factor: expected 3, found 0")), SizeIs(3)));
}

TEST_F(LiveDifference, OfASetupObject) {
  node(kMixer).setup.push_back({{0x1019, 0}, canopen::DataType::u8, 10});
  EXPECT_THAT(
      findings(),
      ElementsAre(StartsWith("drive \"mixer1\": error: 0x1019:00 setup: expected 10, found 0; the gateway writes it")));
}

TEST_F(LiveDifference, OfWhereCommandsComeFrom) {
  set(kFan, {0x2000, 3}, 0);
  set(kFan, {0x2000, 4}, 1);
  set(kPump, {0x2001, 2}, 1);
  set(kPump, {0x2001, 3}, 0);
  EXPECT_THAT(
      findings(),
      ElementsAre("drive \"fan1\": warning: 0x2000:03 command source: expected 2, found 0; at the keypad: F00.02 = 2 "
                  "(RS485)",
                  "drive \"fan1\": warning: 0x2000:04 frequency source: expected 6, found 1; at the keypad: F00.03 = 6 "
                  "(RS485)",
                  "drive \"pump1\": warning: 0x2001:02 command source: expected 3, found 1; at the keypad: F01.01 = 3 "
                  "(option card)",
                  "drive \"pump1\": warning: 0x2001:03 frequency source: expected 10, found 0; at the keypad: F01.02 = "
                  "10 (option card)"));
}

// A drive that takes no commands may be commanded at its keypad.
TEST_F(LiveDifference, OfWhereCommandsComeFromIsNoneWhereNobodyCommands) {
  set(kFan, {0x2000, 3}, 0);
  configured_.drives[kFan].commands.writers = {};
  EXPECT_THAT(findings(), IsEmpty());
}

TEST_F(LiveDifference, OfTheMaximumFrequency) {
  set(kPump, {0x2001, 0x0B}, 4000);
  EXPECT_THAT(findings(),
              ElementsAre(AllOf(StartsWith("drive \"pump1\": warning: 0x2001:0B maximum output frequency is 40 Hz, and "
                                           "frequency_command may be commanded up to 50 Hz, which the drive cuts or "
                                           "refuses; lower max in [drive.signals.frequency_command], or raise the "
                                           "limit; at the keypad: F01.10 (unconfirmed: "))));
}

TEST_F(LiveDifference, OfBeingInRemote) {
  drives_[kMixer]->misbehaviour().local = true;
  EXPECT_THAT(findings(), ElementsAre("drive \"mixer1\": warning: 0x6041:00 remote (bit 9 of the statusword): expected "
                                      "0x200, found 0x0"));
}

TEST_F(LiveDifference, OfALetterWhoseCauseIsNotRead) {
  Running running = read_running(ask(R"({"op":"status"})").value()).value();
  running.drives[kPump].boot = "J";
  running.drives[kPump].boot_text = "it left operational by itself";
  const Comparison comparison = compare(configured_, notes_, running, [this](const std::string& r) { return ask(r); });
  ASSERT_THAT(comparison.findings, SizeIs(1));
  EXPECT_EQ(to_string(comparison.findings.front()), "drive \"pump1\": error: boot J: it left operational by itself");
}

// ---- Drives whose boot ended with a letter: they are there, but not online.

TEST_F(LiveComparison, ALimitIsNotAsConfiguredWhereNoneIs) {
  const Comparison before = look();
  config::Drive& pump = configured_.drives[kPump];
  pump.signals[pump.find("frequency_command").value()].max.reset();
  const Comparison after = look();
  EXPECT_LT(after.objects.alike, before.objects.alike);
  EXPECT_THAT(after.findings, IsEmpty());
}

// Found running otherwise than wanted: left as it is.
TEST_F(LiveDifference, OfADriveThatRunsWithOtherSettings) {
  set(kHoist, {0x1801, 5}, 500);
  drives_[kHoist]->misbehaviour().unplugged = true;
  loop_.advance(5s, 5ms);
  drives_[kHoist]->misbehaviour().unplugged = false;
  ASSERT_TRUE(loop_.advance_until([&] { return letter_of(kHoist) != canopen::BootResult::not_booted; }, 60s));
  ASSERT_EQ(letter_of(kHoist), canopen::BootResult::left_alone);
  EXPECT_THAT(findings(),
              ElementsAre(StartsWith("drive \"hoist1\": error: boot L: "),
                          StartsWith("drive \"hoist1\": error: 0x1801:05 TPDO2 event timer: expected 100, found 500")));
}

// ---- Drives that are not there, and a gateway that runs something else.

TEST_F(LiveComparison, NamesADriveThatIsOffline) {
  drives_[kPump]->power_off();
  loop_.advance(5s, 5ms);
  const Comparison comparison = look();
  ASSERT_THAT(comparison.findings, SizeIs(1));
  EXPECT_THAT(to_string(comparison.findings.front()),
              StartsWith("drive \"pump1\": warning: is offline, so it was not compared"));
  EXPECT_EQ(comparison.drives, 3U);
}

TEST_F(LiveComparison, LeavesADriveAloneThatDoesNotAnswer) {
  drives_[kPump]->misbehaviour().sdo_drops_left = 1000000;
  const Comparison comparison = look();
  ASSERT_THAT(comparison.findings, SizeIs(1));
  EXPECT_THAT(to_string(comparison.findings.front()),
              StartsWith("drive \"pump1\": warning: does not answer, so the rest of it was not compared: 0x1017:00"));
  EXPECT_EQ(comparison.drives, 3U);
}

TEST_F(LiveComparison, TellsWhatADriveRefusesToShow) {
  drives_[kPump]->misbehaviour().sdo_flaw = simulator::SdoFlaw::abort;
  drives_[kPump]->misbehaviour().flaws_left = 1;
  EXPECT_THAT(findings(), ElementsAre(AllOf(StartsWith("drive \"pump1\": warning: 0x1017:00 heartbeat time cannot be "
                                                       "compared: "),
                                            HasSubstr("0x08000000"))));
}

TEST_F(LiveComparison, TellsWhatTheGatewayRunsInstead) {
  configured_.drives[kFan].node.node = 33;
  configured_.drives[kPump].profile = "our-pump";
  configured_.drives[kHoist].name = "hoist2";
  configured_.drives[kMixer].enabled = false;
  EXPECT_THAT(findings(),
              ElementsAre(StartsWith("drive \"fan1\": warning: in the running gateway it is node 3 on bus demo, here "
                                     "node 33 on bus demo, so it was not compared; it runs another configuration"),
                          StartsWith("drive \"pump1\": warning: in the running gateway its profile is veichi-ac310, "
                                     "here our-pump"),
                          StartsWith("drive \"hoist2\": warning: the running gateway has no such drive"),
                          StartsWith("drive \"hoist1\": warning: the running gateway has it, and this configuration "
                                     "does not")));
}

// The time for all of it is over, or the gateway is gone.
TEST_F(LiveComparison, NamesTheDrivesForWhichThereWasNoTime) {
  const auto running = read_running(ask(R"({"op":"status"})").value());
  asked_ = 0;
  const Comparison comparison =
      compare(configured_, notes_, running.value(), [this](const std::string& request) -> std::optional<std::string> {
        return asked_ < 5 ? ask(request) : std::nullopt;
      });
  EXPECT_EQ(comparison.drives, 0U);
  ASSERT_THAT(comparison.findings, SizeIs(4));
  for (const config::Finding& finding : comparison.findings) {
    EXPECT_THAT(to_string(finding), AllOf(HasSubstr("warning: does not answer, so the rest of it was not compared"),
                                          HasSubstr("the gateway did not answer")));
  }
}

}  // namespace
}  // namespace gateway::compare
