// Booting a node as it is seen on the bus: what is read, what is written and in which order, and which letter a failure
// gets.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using Bytes = support::ScriptedSlave::Bytes;

class BootTest : public NodeBench {};

TEST_F(BootTest, AsWantedNothingIsWritten) {
  install(bench_settings());
  boot(bench_settings());
  EXPECT_TRUE(status().online);
  EXPECT_TRUE(status().configured);
  EXPECT_EQ(status().nmt, NmtState::operational);
  EXPECT_EQ(status().boot_result, BootResult::ok);
  EXPECT_TRUE(slave_.writes().empty());
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::booted});
  EXPECT_TRUE(node_->tpdo_verified(1));
  EXPECT_FALSE(node_->tpdo_verified(2));
}

TEST_F(BootTest, WithoutExpectationIdentityIsNotRead) {
  install(bench_settings());
  boot(bench_settings());
  for (const ObjectAddress& object : slave_.reads()) {
    EXPECT_NE(object.index, 0x1000);
    EXPECT_NE(object.index, 0x1018);
  }
}

TEST_F(BootTest, IdentityGivesItsLetter) {
  NodeSettings settings = bench_settings();
  install(settings);
  settings.identity.device_type = 0x00020192;
  boot(settings);
  expect_letter(BootResult::other_device_type, "0x1000:00 device type: expected 0x20192, found 0x10192");
}

TEST_F(BootTest, EveryIdentityEntryHasItsLetter) {
  const std::vector<std::pair<BootResult, std::optional<std::uint32_t> ExpectedIdentity::*>> cases{
      {BootResult::other_vendor, &ExpectedIdentity::vendor},
      {BootResult::other_product, &ExpectedIdentity::product},
      {BootResult::other_revision, &ExpectedIdentity::revision},
      {BootResult::other_serial_number, &ExpectedIdentity::serial}};
  install(bench_settings());
  for (std::uint8_t sub = 1; sub <= 4; ++sub) {
    slave_.set({0x1018, sub}, DataType::u32, 7);
  }
  for (const auto& [letter, member] : cases) {
    NodeSettings settings = bench_settings();
    settings.identity.*member = 8;
    boot(settings);
    expect_letter(letter, "expected 0x8, found 0x7");
    const auto stopped = support::spawn(loop_.executor(), node_->stop());
    loop_.settle();
    ASSERT_TRUE(*stopped);
  }
}

TEST_F(BootTest, IdentityThatCannotBeReadIsNotTheExpectedOne) {
  NodeSettings settings = bench_settings();
  install(settings);
  slave_.remove({0x1018, 1});
  settings.identity.vendor = 0x90;
  boot(settings);
  expect_letter(BootResult::other_vendor, "0x06020000");
}

TEST_F(BootTest, NoAnswerIsLetterB) {
  install(bench_settings());
  slave_.mute_sdo(true);
  boot(bench_settings());
  expect_letter(BootResult::no_answer, "0x1017:00");
}

TEST_F(BootTest, HeartbeatTimeIsWrittenAndReadBack) {
  install(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  boot(bench_settings());
  EXPECT_TRUE(status().online);
  EXPECT_EQ(slave_.writes(), std::vector<ObjectAddress>{kHeartbeatTime});
  EXPECT_EQ(slave_.value(kHeartbeatTime), 500U);
}

TEST_F(BootTest, IgnoredWriteIsLetterJ) {
  install(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 1500);  // A shorter one would do.
  slave_.ignore_write(kHeartbeatTime);
  boot(bench_settings());
  expect_letter(BootResult::not_configured, "0x1017:00 heartbeat time: expected 500, found 1500 after it was written");
}

TEST_F(BootTest, RefusedWriteIsLetterJ) {
  install(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  slave_.refuse_write(kHeartbeatTime, 0x06010002);
  boot(bench_settings());
  expect_letter(BootResult::not_configured, "0x06010002");
  EXPECT_EQ(status().last_abort, 0x06010002U);
}

TEST_F(BootTest, NoHeartbeatIsLetterK) {
  install(bench_settings());
  slave_.heartbeat_off(true);
  boot(bench_settings());
  expect_letter(BootResult::no_heartbeat, "no heartbeat within 1500 ms");
}

TEST_F(BootTest, GatewayIsSupervisedWhereTheDriveCan) {
  NodeSettings settings = bench_settings();
  settings.error_control.supervise_gateway = 2s;
  settings.gateway_node = 127;
  install(settings);
  slave_.set({0x1016, 1}, DataType::u32, 0);
  boot(settings);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(slave_.value({0x1016, 1}), 0x007F07D0U);
}

TEST_F(BootTest, WithoutConsumerObjectTheBootGoesOn) {
  NodeSettings settings = bench_settings();
  settings.error_control.supervise_gateway = 2s;
  install(settings);
  boot(settings);
  EXPECT_TRUE(status().online);
  ASSERT_EQ(events_.remarks.size(), 1U);
  EXPECT_NE(events_.remarks[0].find("0x1016:01"), std::string::npos);
}

TEST_F(BootTest, ConsumerHeartbeatIsUntouchedWithoutSupervision) {
  install(bench_settings());
  slave_.set({0x1016, 1}, DataType::u32, 0);
  boot(bench_settings());
  for (const ObjectAddress& object : slave_.reads()) {
    EXPECT_NE(object.index, 0x1016);
  }
}

TEST_F(BootTest, FurtherSettingsAreMadeSoInTheirOrder) {
  NodeSettings settings = bench_settings();
  settings.setup = {{{0x6007, 0}, DataType::i16, static_cast<Raw>(-1)}, {{0x2000, 1}, DataType::u16, 3}};
  install(settings);
  slave_.set({0x6007, 0}, DataType::i16, 0);
  slave_.set({0x2000, 1}, DataType::u16, 4);
  boot(settings);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(slave_.writes(), (std::vector<ObjectAddress>{{0x6007, 0}, {0x2000, 1}}));
  EXPECT_EQ(slave_.value({0x6007, 0}), 0xFFFFU);
}

TEST_F(BootTest, DriveThatIgnoresStartIsNotOnline) {
  install(bench_settings());
  slave_.ignore_nmt(true);
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(2500ms);
  EXPECT_FALSE(status().online);
  EXPECT_EQ(status().boot_result, BootResult::not_configured);
  EXPECT_NE(status().boot_text.find("stays pre-operational"), std::string::npos) << status().boot_text;
}

TEST_F(BootTest, FailedBootIsTriedAgainAfterAPause) {
  install(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 1000);
  slave_.refuse_write(kHeartbeatTime, 0x08000000);
  boot(bench_settings());
  expect_letter(BootResult::not_configured, "0x1017:00");
  slave_.set(kHeartbeatTime, DataType::u16, 500);
  loop_.advance(2s);
  EXPECT_FALSE(status().online);
  loop_.advance(3s);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(status().boot_result, BootResult::ok);
  EXPECT_TRUE(status().boot_text.empty());
}

TEST_F(BootTest, LostAnswersAreTriedAgain) {
  install(bench_settings());
  int requests = 0;
  slave_.script([&requests](const Bytes&) -> std::optional<std::vector<Bytes>> {
    return ++requests % 3 == 0 ? std::optional(std::vector<Bytes>{}) : std::nullopt;
  });
  start(bench_settings());
  slave_.boot_up();
  EXPECT_TRUE(wait_online(6s));
}

TEST_F(BootTest, BootUpDuringABootBeginsAgain) {
  install(bench_settings());
  slave_.delay_answers(80ms);
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(510ms);
  const std::size_t reads = slave_.reads().size();
  EXPECT_GT(reads, 3U);
  EXPECT_TRUE(nmt_heard().empty());
  slave_.forget_heard();
  slave_.boot_up();
  ASSERT_TRUE(wait_online(5s));
  EXPECT_EQ(slave_.reads().front(), kHeartbeatTime);
  EXPECT_EQ(slave_.reads().size(), 13U) << "all of it was read again";
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
  EXPECT_EQ(status().boot_ups, 2U);
  EXPECT_EQ(events_.boot_ups, 2);
  EXPECT_EQ(events_.arrivals.size(), 1U);
}

TEST_F(BootTest, BootUpWhileStartIsUnderWayBeginsAgain) {
  install(bench_settings());
  slave_.ignore_nmt(true);
  start(bench_settings());
  slave_.boot_up();
  ASSERT_TRUE(loop_.advance_until([this] { return !nmt_heard().empty(); }, 1s));
  slave_.ignore_nmt(false);
  slave_.boot_up();
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(nmt_heard().size(), 2U);
}

}  // namespace
}  // namespace canopen
