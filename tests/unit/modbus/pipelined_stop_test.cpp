// Requests that a client sends without waiting for answers, and stops among them and beside them.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::Bytes;
using modbus_test::frame;
using modbus_test::kControlObject;
using modbus_test::kUnit;
using modbus_test::Site;
using modbus_test::TcpClient;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr const char* kSlowWrite = "06 012c 0001";
constexpr const char* kRunRequest = "06 0064 0001";
constexpr const char* kStopRequest = "06 0064 0005";
constexpr const char* kStopped = "86 04";

config::Model model_with_stop() {
  config::Model model = modbus_test::example_model();
  canopen::MotorSigns& motor = model.drives[0].node.motor;
  motor.control = kControlObject;
  motor.stops = {{0xFFFF, 5}, {0xFFFF, 6}};
  return model;
}

/// A drive that is up, and a client whose write it does not answer.
class PipelinedStop : public testing::Test {
 protected:
  void SetUp() override {
    site_.bring_up();
    EXPECT_EQ(site_.ask(other_, kUnit, "03 0064 0001"), "03 02 0000");
  }
  void send(TcpClient& client, const std::vector<const char*>& pdus) {
    Bytes all;
    for (const char* const pdu : pdus) {
      const Bytes one = frame(pdu[0] == '!' ? std::uint8_t{0} : kUnit, pdu[0] == '!' ? pdu + 1 : pdu);
      all.insert(all.end(), one.begin(), one.end());
    }
    ASSERT_EQ(client.send(all), all.size());
    site_.settle();
  }
  /// A write is under way, and nothing comes back.
  void begin_slow_write(const std::vector<const char*>& behind = {}) {
    site_.puppet().mute = true;
    std::vector<const char*> all{kSlowWrite};
    all.insert(all.end(), behind.begin(), behind.end());
    send(client_, all);
  }
  /// The drive answers again, but not what it was asked before; a stop does not wait for that longer than 100 ms.
  std::string ask_meanwhile(TcpClient& client, const char* pdu) {
    send(client, {pdu});
    site_.run(milliseconds(150));
    return site_.answer(client);
  }
  [[nodiscard]] std::vector<std::uint64_t> control_words() {
    std::vector<std::uint64_t> words;
    for (const canopen::ObjectValue& value : site_.puppet().written) {
      if (value.object == kControlObject) {
        words.push_back(static_cast<std::uint64_t>(value.raw));
      }
    }
    return words;
  }
  using Words = std::vector<std::uint64_t>;

  Site site_{model_with_stop()};
  TcpClient client_{site_.port()};
  TcpClient other_{site_.port()};
};

TEST_F(PipelinedStop, LeavesWhateverStandsBesideIt) {
  EXPECT_EQ(site_.ask(other_, kUnit, "10 0064 0003 06 0001 1388 0001"), "90 02");  // The drive has no 102.
  EXPECT_TRUE(site_.puppet().rpdos.empty());
  EXPECT_EQ(site_.ask(other_, kUnit, "10 0064 0003 06 0005 1388 0001"), "90 02");
  ASSERT_EQ(site_.puppet().rpdos.size(), 1U);
  EXPECT_EQ(site_.puppet().rpdos[0].data[0], 5U);
  EXPECT_EQ(site_.ask(other_, kUnit, "17 0064 0001 0064 0003 06 0006 1388 0001"), "97 02");
  ASSERT_EQ(site_.puppet().rpdos.size(), 2U);
  EXPECT_EQ(site_.puppet().rpdos[1].data[0], 6U);
}

TEST_F(PipelinedStop, ARunBehindASlowWriteIsNotSentAfterTheStopOfAnotherConnection) {
  begin_slow_write({kRunRequest});
  site_.loop().advance(milliseconds(100), milliseconds(10));
  site_.puppet().mute = false;
  EXPECT_EQ(ask_meanwhile(other_, kStopRequest), kStopRequest);
  site_.run(seconds(3));
  EXPECT_EQ(site_.answer(client_), "86 0b") << "the slow write";
  EXPECT_EQ(site_.answer(client_), kStopped) << "superseded";
  EXPECT_EQ(control_words(), Words{5});
}

TEST_F(PipelinedStop, NorOneThatCameWhileTheWriteWasUnderWay) {
  begin_slow_write();
  site_.loop().advance(milliseconds(100), milliseconds(10));
  send(client_, {kRunRequest});
  site_.loop().advance(milliseconds(100), milliseconds(10));
  site_.puppet().mute = false;
  EXPECT_EQ(ask_meanwhile(other_, kStopRequest), kStopRequest);
  site_.run(seconds(3));
  EXPECT_EQ(site_.answer(client_), "86 0b");
  EXPECT_EQ(site_.answer(client_), kStopped);
  EXPECT_EQ(control_words(), Words{5});
}

TEST_F(PipelinedStop, ARunSentRightAfterAnAnswerIsAsNewAsItIs) {
  begin_slow_write();
  site_.loop().advance(milliseconds(100), milliseconds(10));
  site_.puppet().mute = false;
  EXPECT_EQ(ask_meanwhile(other_, kStopRequest), kStopRequest);
  EXPECT_EQ(ask_meanwhile(other_, kRunRequest), kRunRequest);
  EXPECT_EQ(ask_meanwhile(other_, kStopRequest), kStopRequest);
  site_.run(seconds(3));
  EXPECT_EQ(site_.answer(client_), "86 0b");
  EXPECT_EQ(site_.ask(client_, kUnit, kRunRequest), kRunRequest);
  EXPECT_EQ(control_words(), (Words{5, 1, 5, 1}));
}

TEST_F(PipelinedStop, AStopGoesBeforeTheWritesInFrontOfIt) {
  site_.puppet().written.clear();
  send(client_,
       {"06 012c 0001", kRunRequest, "06 012c 0002", "03 0064 0001", kStopRequest, "03 0064 0001", "06 012c 0003"});
  for (const char* const expected :
       {"06 012c 0001", kStopped, "06 012c 0002", "03 02 0005", kStopRequest, "03 02 0005"}) {
    EXPECT_EQ(site_.answer(client_), expected);
  }
  EXPECT_EQ(site_.answer(client_), "06 012c 0003");
  ASSERT_FALSE(site_.puppet().written.empty());
  EXPECT_EQ(site_.puppet().written.front().object, kControlObject);
  EXPECT_EQ(control_words(), Words{5}) << "once, and no run";
}

TEST_F(PipelinedStop, WhatIsSentBehindAStopInOnePieceIsNewerThanIt) {
  send(client_, {kRunRequest, kStopRequest, kRunRequest});
  EXPECT_EQ(site_.answer(client_), kStopped);
  EXPECT_EQ(site_.answer(client_), kStopRequest);
  EXPECT_EQ(site_.answer(client_), kRunRequest);
  EXPECT_EQ(control_words(), (Words{5, 1}));
}

TEST_F(PipelinedStop, AStopWaitsForTheOneWriteThatIsUnderWayAndNoMore) {
  begin_slow_write({"06 012c 0002", "06 012c 0003", "06 012c 0004"});
  site_.loop().advance(milliseconds(100), milliseconds(10));
  send(client_, {kStopRequest});
  site_.puppet().mute = false;
  site_.run(seconds(2));
  ASSERT_FALSE(site_.puppet().written.empty());
  EXPECT_EQ(site_.puppet().written.front().object, kControlObject);
}

TEST_F(PipelinedStop, SoDoesAStopForAll) {
  send(client_, {"06 012c 0001", kRunRequest, "!06 0014 0001"});
  EXPECT_EQ(site_.answer(client_), "06 012c 0001");
  EXPECT_EQ(site_.answer(client_), kStopped);
  EXPECT_EQ(site_.answer(client_), "06 0014 0001");
  ASSERT_FALSE(site_.puppet().written.empty());
  EXPECT_EQ(site_.puppet().written.front().object, kControlObject);
}

TEST_F(PipelinedStop, TwoStopsAreAnsweredInOrder) {
  send(client_, {"06 012c 0001", "06 0064 0006", kStopRequest, "06 012c 0002"});
  EXPECT_EQ(site_.answer(client_), "06 012c 0001");
  EXPECT_EQ(site_.answer(client_), "06 0064 0006");
  EXPECT_EQ(site_.answer(client_), kStopRequest);
  EXPECT_EQ(site_.answer(client_), "06 012c 0002");
  EXPECT_EQ(control_words(), (Words{6, 5}));
}

}  // namespace
