// The SDO client over time: retries, deadlines, interruptions, who goes first.

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/bus_fixture.h"
#include "tests/unit/canopen/sdo_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class SdoClientTest : public SdoBench {};

TEST_F(SdoClientTest, SilenceAmongSegmentsIsAborted) {
  slave_.script([](const Bytes& request) -> std::optional<Answers> {
    if (request[0] == 0x40) {
      return Answers{{0x41, 0x08, 0x10, 0x00, 10, 0, 0, 0}};
    }
    return Answers{};
  });
  use({.retries = 0});
  const auto reading = read(kName, DataType::u64);
  loop_.advance(499ms);
  EXPECT_FALSE(reading.done());
  loop_.advance(2ms);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::timeout);
  EXPECT_EQ(slave_.heard().back(), make_frame(0x605, Bytes{0x80, 0x08, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05}));
}

TEST_F(SdoClientTest, ReadsAreTriedAgain) {
  int requests = 0;
  slave_.script([&requests](const Bytes&) -> std::optional<Answers> {
    return ++requests < 3 ? Answers{} : Answers{{0x4B, 0x30, 0x20, 0x03, 7, 0, 0, 0}};
  });
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(999ms);
  EXPECT_FALSE(reading.done());
  loop_.advance(3ms);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().value(), 7U);
  EXPECT_EQ(requests, 3);
}

TEST_F(SdoClientTest, SilenceIsATimeoutAfterTheRetries) {
  slave_.mute_sdo(true);
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(1510ms);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::timeout);
  EXPECT_EQ(reading.get().error().object, kStatus);
  EXPECT_FALSE(reading.get().error().outcome_unknown);
  EXPECT_FALSE(reading.get().error().not_sent);
  EXPECT_EQ(reading.get().error().detail, "no answer in 500 ms");
  EXPECT_FALSE(client_->answered());
  EXPECT_EQ(slave_.heard_on(0x605).size(), 3U);
}

TEST_F(SdoClientTest, ARequestThatCannotLeaveSaysNothingAboutTheNode) {
  slave_.set(kStatus, DataType::u16, 1);
  closed_ = true;
  const auto reading = read(kStatus, DataType::u16);
  const auto writing = write(kStatus, DataType::u16, 2);
  ASSERT_TRUE(loop_.advance_until([&] { return writing.done(); }, 10s));
  for (const Error& error : {reading.get().error(), writing.get().error()}) {
    EXPECT_EQ(error.kind, ErrorKind::timeout);
    EXPECT_TRUE(error.not_sent);
  }
  closed_ = false;
  loop_.advance(1s);
  EXPECT_TRUE(slave_.heard_on(0x605).empty());
}

TEST_F(SdoClientTest, CommandOnADeadBusIsOffline) {
  wire_.set_state({BusCondition::bus_off, 0, 0});
  loop_.settle();
  const auto writing = command(kCommand, 5);
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(2ms);
  ASSERT_TRUE(writing.done() && reading.done());
  EXPECT_EQ(writing.get().error().kind, ErrorKind::offline);
  EXPECT_FALSE(writing.get().error().outcome_unknown);
  EXPECT_EQ(reading.get().error().kind, ErrorKind::offline);
  wire_.set_state({BusCondition::error_active, 0, 0});
}

TEST_F(SdoClientTest, RefusedCommandIsCertain) {
  slave_.set(kCommand, DataType::u16, 0);
  slave_.refuse_write(kCommand, 0x08000022);
  const Result<void> result = command_now(kCommand, 5);
  ASSERT_TRUE(result.has_error());
  EXPECT_EQ(result.error().kind, ErrorKind::refused);
  EXPECT_EQ(result.error().abort, 0x08000022U);
  EXPECT_FALSE(result.error().outcome_unknown);
}

TEST_F(SdoClientTest, OneAtATimeInOrder) {
  slave_.set({0x2000, 1}, DataType::u16, 1);
  slave_.set({0x2000, 2}, DataType::u16, 2);
  slave_.set({0x2000, 3}, DataType::u16, 3);
  slave_.delay_answers(10ms);
  const auto first = read({0x2000, 1}, DataType::u16);
  const auto second = read({0x2000, 2}, DataType::u16);
  const auto third = read({0x2000, 3}, DataType::u16);
  loop_.advance(5ms);
  EXPECT_EQ(slave_.reads().size(), 1U);
  loop_.advance(10ms);
  EXPECT_EQ(slave_.reads().size(), 2U);
  loop_.advance(40ms);
  ASSERT_TRUE(first.done() && second.done() && third.done());
  EXPECT_EQ(first.get().value(), 1U);
  EXPECT_EQ(second.get().value(), 2U);
  EXPECT_EQ(third.get().value(), 3U);
  EXPECT_EQ(slave_.reads(), (std::vector<ObjectAddress>{{0x2000, 1}, {0x2000, 2}, {0x2000, 3}}));
}

TEST_F(SdoClientTest, CommandsGoBeforeReadsThatWait) {
  slave_.set(kStatus, DataType::u16, 1);
  slave_.set(kCommand, DataType::u16, 0);
  slave_.delay_answers(10ms);
  const auto first = read(kStatus, DataType::u16);
  const auto second = read(kStatus, DataType::u16);
  const auto writing = command(kCommand, 5);
  const auto another = command(kCommand, 6);
  loop_.advance(50ms);
  ASSERT_TRUE(first.done() && second.done() && writing.done() && another.done());
  const std::vector<Frame> heard = slave_.heard_on(0x605);
  ASSERT_EQ(heard.size(), 4U);
  EXPECT_EQ(heard[1].data[4], 5U);
  EXPECT_EQ(heard[2].data[4], 6U);
}

TEST_F(SdoClientTest, ACommandGoesBetweenTheTriesOfARead) {
  slave_.set(kCommand, DataType::u16, 0);
  slave_.mute(kStatus);
  const auto reading = read(kStatus, DataType::u16);
  const auto behind = read(kCommand, DataType::u16);
  loop_.advance(10ms);
  const auto writing = command(kCommand, 5);
  loop_.advance(500ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value());
  EXPECT_FALSE(behind.done()) << "among reads the order stays";
  loop_.advance(1010ms);
  ASSERT_TRUE(reading.done() && behind.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::timeout);
  EXPECT_EQ(behind.get().value(), 5U);
  EXPECT_EQ(slave_.reads().size(), 4U);
}

TEST_F(SdoClientTest, ACommandEndsALongUploadWhichIsBegunAnew) {
  slave_.set_bytes(kName, Bytes(250, 1));
  slave_.set(kCommand, DataType::u16, 0);
  slave_.delay_answers(30ms);
  const auto reading = read(kName, DataType::u64);
  loop_.advance(100ms);
  const auto writing = command(kCommand, 5);
  loop_.advance(65ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value()) << to_string(writing.get().error());
  EXPECT_FALSE(reading.done());
  const std::vector<Frame> heard = slave_.heard_on(0x605);
  EXPECT_EQ(std::count(heard.begin(), heard.end(), make_frame(0x605, Bytes{0x80, 0x08, 0x10, 0, 0, 0, 0, 0x08})), 1);
  ASSERT_TRUE(loop_.advance_until([&] { return reading.done(); }, 2s));
  EXPECT_EQ(reading.get().value(), 0x0101010101010101U);
  EXPECT_EQ(slave_.reads(), (std::vector<ObjectAddress>{kName, kName})) << "no proof was needed";
}

TEST_F(SdoClientTest, ALongUploadIsEndedAlsoWhileItsRequestWaits) {
  slave_.set_bytes(kName, Bytes(250, 1));
  slave_.set(kCommand, DataType::u16, 0);
  slave_.delay_answers(30ms);
  const auto reading = support::spawn(loop_.executor(), client_->probe(kName, DataType::u64));
  loop_.advance(100ms);
  closed_ = true;
  loop_.advance(30ms);
  const auto writing = command(kCommand, 5);
  loop_.advance(10ms);
  closed_ = false;
  loop_.advance(70ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value());
  ASSERT_TRUE(loop_.advance_until([&] { return reading.done(); }, 2s));
  EXPECT_TRUE(reading.get().has_value()) << "giving way uses up no try";
}

TEST_F(SdoClientTest, InterruptionWithdrawsACommandFromTheTransmitQueue) {
  slave_.send(0x705, {5});  // The bus shows life.
  loop_.advance(1ms);
  wire_.withhold_echoes(true);
  const Frame other = make_frame(0x606, Bytes{0x40, 0, 0, 0, 0, 0, 0, 0});
  const auto blocking = support::spawn(loop_.executor(), support::send_command(bus_, other, Clock::now() + 50ms));
  const auto writing = command(kCommand, 5);
  loop_.settle();
  client_->interrupt();
  loop_.settle();
  ASSERT_TRUE(writing.done());
  EXPECT_EQ(writing.get().error().kind, ErrorKind::offline);
  EXPECT_FALSE(writing.get().error().outcome_unknown);
  wire_.withhold_echoes(false);
  loop_.advance(1s);
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(SdoClientTest, ACommandWithdrawnWhileItWaitsNeverLeavesAndTheReadGoesOn) {
  slave_.set(kCommand, DataType::u16, 0);
  slave_.set(kStatus, DataType::u16, 0);
  slave_.delay_answers(100ms);
  const auto reading = read(kStatus, DataType::u16);
  const auto writing = command(kCommand, 1);
  loop_.advance(50ms);
  EXPECT_FALSE(writing.done());
  client_->withdraw_commands();
  loop_.advance(60ms);
  ASSERT_TRUE(writing.done());
  EXPECT_EQ(writing.get().error().kind, ErrorKind::offline);
  EXPECT_TRUE(writing.get().error().not_sent);
  EXPECT_FALSE(writing.get().error().outcome_unknown);
  ASSERT_TRUE(reading.done());
  EXPECT_TRUE(reading.get().has_value());
  loop_.advance(1s);
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(SdoClientTest, InterruptionFailsEverythingAndTheClientGoesOn) {
  slave_.mute_sdo(true);
  const auto reading = read(kStatus, DataType::u16);
  const auto waiting = command(kCommand, 5);
  loop_.advance(10ms);
  const std::size_t heard = slave_.heard().size();
  client_->interrupt();
  loop_.advance(1ms);
  ASSERT_TRUE(reading.done() && waiting.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::offline);
  EXPECT_EQ(waiting.get().error().kind, ErrorKind::offline);
  EXPECT_FALSE(waiting.get().error().outcome_unknown);
  EXPECT_EQ(slave_.heard().size(), heard);
  slave_.mute_sdo(false);
  slave_.set(kStatus, DataType::u16, 3);
  EXPECT_EQ(read_now(kStatus, DataType::u16).value(), 3U);
}

TEST_F(SdoClientTest, InterruptedCommandThatHadBegunIsUnknown) {
  slave_.mute_sdo(true);
  const auto writing = command(kCommand, 5);
  loop_.advance(10ms);
  client_->interrupt();
  loop_.advance(1ms);
  ASSERT_TRUE(writing.done());
  EXPECT_EQ(writing.get().error().kind, ErrorKind::offline);
  EXPECT_TRUE(writing.get().error().outcome_unknown);
}

TEST_F(SdoClientTest, CommandWithoutEchoIsConfirmedByItsAnswer) {
  slave_.set(kCommand, DataType::u16, 0);
  slave_.send(0x705, {5});  // The bus shows life.
  loop_.advance(1ms);
  wire_.withhold_echoes(true);
  const auto writing = command(kCommand, 5);
  loop_.advance(110ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value());
}

}  // namespace
}  // namespace canopen
