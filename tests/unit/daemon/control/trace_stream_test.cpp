#include <gmock/gmock.h>

#include <list>
#include <regex>
#include <string>
#include <vector>

#include "daemon/control/status_table.h"
#include "daemon/temporary_directory.h"
#include "tests/support/bus_fixture.h"
#include "tests/support/frame.h"
#include "tests/unit/daemon/control/raw_client.h"
#include "tests/unit/daemon/demo_model.h"
#include "tests/unit/daemon/demo_plant.h"

namespace gateway::control {
namespace {

using namespace std::chrono_literals;
using test::RawClient;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

const TemporaryDirectory& directory() {
  static const TemporaryDirectory made;
  return made;
}

config::Model traced_model() {
  config::Model model = gateway::test::demo_model();
  model.modbus.reset();
  model.mqtt.reset();
  model.http.reset();
  model.gateway.control = (directory().path() / "control").string();
  return model;
}

// The demo's gateway with its control socket.
class TracedPlant : public gateway::test::DemoPlant {
 protected:
  TracedPlant() : DemoPlant(traced_model()) { begin_plant(); }
  ~TracedPlant() override { end_plant(); }

  RawClient& connect() {
    RawClient& client = clients_.emplace_back(model_.gateway.control);
    loop_.settle();
    return client;
  }
  std::vector<std::string> ask(RawClient& client, const std::string& text, canopen::Duration wait = 600ms) {
    EXPECT_EQ(client.send(text + "\n"), text.size() + 1);
    loop_.advance(wait);
    return client.lines();
  }

  std::list<RawClient> clients_;
};

TEST_F(TracedPlant, TraceTellsFramesInWords) {
  RawClient& client = connect();
  const std::vector<std::string> lines = ask(client, R"({"id":"t","op":"trace","names":"pump1"})");
  ASSERT_THAT(lines, Not(IsEmpty()));
  EXPECT_EQ(lines.front(), R"({"id":"t","ok":true,"stream":true})");
  EXPECT_THAT(lines, Each(StartsWith("{\"id\":\"t\",")));
  EXPECT_THAT(lines, Contains(AllOf(HasSubstr(R"("kind":"heartbeat","owner":"pump1","name":"heartbeat")"),
                                    HasSubstr(R"("text":"operational")"))));
  EXPECT_THAT(lines, Contains(AllOf(HasSubstr(R"("name":"TPDO1","text":"status_word 0x)"), HasSubstr(" Hz"))));
  EXPECT_THAT(lines, Not(Contains(HasSubstr("fan1"))));

  EXPECT_THAT(ask(connect(), R"({"id":1,"op":"trace","names":"can7"})"),
              Contains(AllOf(HasSubstr(R"("code":"unknown")"), HasSubstr("no drive or bus"))));
}

TEST_F(TracedPlant, OurOwnFramesAreMarkedAndACommandIsSeen) {
  RawClient& client = connect();
  (void)ask(client, R"({"id":1,"op":"trace","names":"pump1","kinds":"sdo"})", 0ms);
  (void)ask(connect(), R"({"id":2,"op":"sdo-read","drive":"pump1","object":"0x2021:02"})", 100ms);
  const std::vector<std::string> lines = client.lines();
  EXPECT_THAT(lines,
              Contains(AllOf(HasSubstr(R"("own":true)"), HasSubstr(R"("text":"read 0x2021:02 output_frequency")"))));
  EXPECT_THAT(lines, Contains(AllOf(HasSubstr(R"("own":false)"),
                                    HasSubstr(R"("text":"answer: 0x2021:02 output_frequency = 0.00 Hz")"))));
}

TEST_F(TracedPlant, RawIsCandumpsLog) {
  RawClient& client = connect();
  const std::vector<std::string> lines = ask(client, R"({"id":1,"op":"trace","cob_ids":"0x705","raw":true})", 1200ms);
  ASSERT_THAT(lines, SizeIs(testing::Ge(2U)));
  EXPECT_THAT(lines.back(), testing::MatchesRegex(R"re(\{"id":1,"raw":"\([0-9]+\.[0-9]{6}\) demo 705#05"\})re"));
}

// It takes nothing for a while: it is told how many frames it lost, and the plant is as it was.
TEST_F(TracedPlant, ASlowReaderLosesFramesCounted) {
  RawClient& slow = connect();
  RawClient& quick = connect();
  EXPECT_GT(slow.send("{\"id\":1,\"op\":\"trace\",\"cob_ids\":\"6FF\"}\n"), 0U);
  EXPECT_GT(quick.send("{\"id\":1,\"op\":\"trace\",\"cob_ids\":\"6FF\"}\n"), 0U);
  loop_.settle();
  support::Listener stranger(wire_);
  constexpr std::size_t kFrames = 10'000;
  std::size_t told_quick = 0;
  for (std::size_t i = 0; i < kFrames; ++i) {
    (void)stranger.link->send(support::frame(0x6FF, 1));
    if (i % 100 == 99) {
      loop_.advance(50ms, 5ms);
      told_quick += quick.lines().size();
    }
  }
  loop_.advance(100ms);
  told_quick += quick.lines().size();
  EXPECT_EQ(told_quick, kFrames + 1) << "who reads loses none";
  EXPECT_EQ(gateway_.plant().online(), drives_.size());
  std::size_t told = 0;
  std::size_t lost = 0;
  for (int i = 0; i < 60; ++i) {
    for (const std::string& line : slow.lines()) {
      told += line.find("\"ts\"") != std::string::npos ? 1U : 0U;
      if (std::smatch found; std::regex_search(line, found, std::regex(R"re("lost":([0-9]+))re"))) {
        lost += std::stoul(found[1]);
      }
    }
    loop_.advance(50ms);
  }
  EXPECT_GT(lost, 0U);
  EXPECT_GE(told + lost, kFrames) << "each is told or counted, and what was lost of others";
  EXPECT_FALSE(slow.ended());
}

TEST_F(TracedPlant, AWatchedStatusComesAtChangesAndEachFiveSecondsAtLeast) {
  drives_.clear();
  loop_.advance(5s);
  RawClient& client = connect();
  std::vector<std::string> lines = ask(client, R"({"id":1,"op":"status","watch":true})", 400ms);
  ASSERT_THAT(lines, SizeIs(2));
  EXPECT_EQ(lines.front(), R"({"id":1,"ok":true,"stream":true})");
  EXPECT_THAT(lines.back(), AllOf(StartsWith(R"({"id":1,"status":{"ts":")"), HasSubstr(R"("name":"pump1")")));
  loop_.advance(4s);
  EXPECT_THAT(client.lines(), IsEmpty()) << "nothing changed";
  loop_.advance(1s);
  EXPECT_THAT(client.lines(), SizeIs(1)) << "it lives";
  const config::Drive& pump = model_.drives.at(1);
  drives_.push_back(simulator::make_drive(pump.profile, pump.node.node, network_, {}));
  drives_.back()->power_on();
  loop_.advance(3s);
  lines = client.lines();
  EXPECT_THAT(lines, SizeIs(testing::AllOf(testing::Ge(1U), testing::Le(7U)))) << "twice a second at most";
  EXPECT_THAT(lines,
              Contains(HasSubstr(
                  R"("name":"pump1","bus":"demo","node":5,"profile":"veichi-ac310","enabled":true,"online":true)")));
}

TEST(StatusTable, CanLeaveOutWhatTimeAloneChanges) {
  const std::string status = R"({"ts":"2026-01-02T03:04:05.678Z","gateway":"line3","version":"1","uptime":12.3,)"
                             R"("buses":[{"name":"can0","state":"error-active","load":11.3}],)"
                             R"("drives":[{"name":"pump1","bus":"can0","node":5,"enabled":true,"online":true,)"
                             R"("nmt":"operational","boot":"ok","heartbeat_age":0.3}]})";
  const std::string shown = status_table(status).value();
  EXPECT_THAT(shown, AllOf(HasSubstr("up 12.3 s"), HasSubstr("load 11.3 %"), HasSubstr("0.3 s")));
  const std::string lasting = status_table(status, TableAges::hidden).value();
  EXPECT_THAT(lasting,
              AllOf(HasSubstr("operational"), Not(HasSubstr("12.3")), Not(HasSubstr("11.3")), Not(HasSubstr("0.3 s"))));
  EXPECT_EQ(status_time(status), "2026-01-02T03:04:05.678Z");
  EXPECT_EQ(status_time("nonsense"), "");
}

}  // namespace
}  // namespace gateway::control
