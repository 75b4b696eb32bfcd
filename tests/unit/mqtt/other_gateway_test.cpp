#include "bridges/mqtt/other_gateway.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace mqtt {
namespace {

using namespace std::chrono_literals;

class OtherGatewayTest : public testing::Test {
 protected:
  static constexpr const char* kHealth = "canopen/line3/health";
  static constexpr const char* kOurs = "aaaa000011112222";
  static constexpr const char* kOther = "bbbb000011112222";

  static std::string health(const std::string& instance, const std::string& ts = "2026-01-02T03:04:05.678Z") {
    return R"({"ts":")" + ts + R"(","instance":")" + instance + R"(","uptime":1,"buses":[{"name":"can0"}]})";
  }
  bool live(const std::string& payload, canopen::TimePoint now) {
    return other_.heard({.topic = kHealth, .payload = payload}, now);
  }
  bool kept(const std::string& payload, canopen::TimePoint now) {
    return other_.heard({.topic = kHealth, .payload = payload, .retained = true}, now);
  }
  void connect(canopen::TimePoint now, const std::string& broker = "b:1883") {
    other_.connected(broker);
    other_.listening(now);
  }

  OtherGatewayTest() { settings_.expiry = 90s; }
  config::Mqtt settings_;
  std::vector<std::string> notices_;
  int changes_ = 0;
  OtherGateway other_{kOurs, settings_, [this](Level, std::string text) { notices_.push_back(std::move(text)); },
                      [this] { ++changes_; }};
  const canopen::TimePoint start_{1h};
};

TEST_F(OtherGatewayTest, IsKnownByItsInstanceAndSaidOnce) {
  connect(start_);
  EXPECT_FALSE(live(health(kOurs), start_)) << "our own come back with MQTT 3.1.1";
  EXPECT_FALSE(other_.lives());
  EXPECT_FALSE(live(health(kOther), start_));
  EXPECT_EQ(other_.who(), kOther);
  EXPECT_EQ(changes_, 1);
  live(health(kOther), start_ + 30s);
  live(health(kOurs), start_ + 30s);
  EXPECT_EQ(changes_, 1);
  ASSERT_EQ(notices_.size(), 1U);
  for (const char* part : {kOurs, kOther, kHealth, "[gateway] name"}) {
    EXPECT_NE(notices_[0].find(part), std::string::npos) << notices_[0];
  }
}

TEST_F(OtherGatewayTest, IsGoneWhenNothingWasHeardOfItForALifetimeInWhichItCouldHaveBeen) {
  connect(start_);
  live(health(kOther), start_);
  live(health(kOther), start_ + 30s);
  EXPECT_EQ(other_.next(), start_ + 120s);
  other_.lost();
  EXPECT_EQ(other_.next(), canopen::kNever);
  other_.tick(start_ + 300s);
  EXPECT_TRUE(other_.lives()) << "who could have heard it?";
  connect(start_ + 300s);
  other_.tick(start_ + 390s - 1ms);
  EXPECT_TRUE(other_.lives());
  other_.tick(start_ + 390s);
  EXPECT_FALSE(other_.lives());
  EXPECT_EQ(changes_, 2);
  EXPECT_EQ(notices_.size(), 2U);
  other_.tick(start_ + 400s);
  EXPECT_EQ(notices_.size(), 2U);
}

TEST_F(OtherGatewayTest, WhatLivesForEverIsGoneAfterThreeIntervals) {
  settings_.expiry = 0s;
  connect(start_);
  live(health(kOther), start_);
  EXPECT_EQ(other_.next(), start_ + 180s);
}

TEST_F(OtherGatewayTest, WhatTheBrokerKeptOfOurLastLifeIsNone) {
  other_.connected("b:1883");
  EXPECT_FALSE(kept(health(kOther), start_));
  other_.listening(start_);
  other_.lost();
  connect(start_ + 10s);
  EXPECT_FALSE(kept(health(kOther), start_ + 10s)) << "still the same; our own was lost with the connection";
  EXPECT_FALSE(other_.lives());
}

TEST_F(OtherGatewayTest, InfoThatWasKeptSaysNothingOfWhen) {
  const Incoming info{.topic = "canopen/line3/info", .payload = R"({"instance":"bbbb"})", .retained = true};
  other_.connected("b:1883");
  kept(health(kOther), start_);
  EXPECT_FALSE(other_.heard(info, start_));
  other_.listening(start_);
  other_.lost();
  connect(start_ + 1s);
  EXPECT_FALSE(other_.heard(info, start_ + 1s));
  EXPECT_FALSE(kept(health(kOther), start_ + 1s));
  EXPECT_FALSE(other_.lives());
}

TEST_F(OtherGatewayTest, WhoPublishedWhileWeWereAwayMayHaveTakenOurClientId) {
  connect(start_);
  other_.lost();
  other_.connected("b:1883");
  EXPECT_TRUE(kept(health(kOther), start_ + 1s));
  EXPECT_EQ(other_.who(), kOther);
  other_.listening(start_ + 1s);
  other_.lost();
  other_.connected("b:1883");
  EXPECT_FALSE(kept(health(kOurs), start_ + 2s));
}

TEST_F(OtherGatewayTest, WhoWasHeardBesideUsHasAClientIdOfHisOwn) {
  connect(start_);
  live(health(kOther), start_);
  other_.lost();
  connect(start_ + 1s);
  EXPECT_FALSE(kept(health(kOther), start_ + 1s));
  EXPECT_TRUE(other_.lives());
}

TEST_F(OtherGatewayTest, WhoWasThereBeforeUsAndPublishesAgainIsNotOurLastLife) {
  connect(start_);
  EXPECT_FALSE(kept(health(kOther, "2026-01-02T03:04:05.678Z"), start_));
  other_.lost();
  connect(start_ + 10s);
  EXPECT_FALSE(kept(health(kOther, "2026-01-02T03:04:05.678Z"), start_ + 10s));
  EXPECT_TRUE(kept(health(kOther, "2026-01-02T03:04:15.678Z"), start_ + 10s));
}

TEST_F(OtherGatewayTest, ABrokerThatIsRestartedWithAnOlderStoreShowsALifeBeforeOurLast) {
  connect(start_);
  kept(health("cccc", "2026-01-02T03:04:05.678Z"), start_);
  other_.lost();
  connect(start_ + 10s);
  EXPECT_FALSE(kept(health(kOther, "2026-01-02T03:00:00.000Z"), start_ + 10s));
  EXPECT_FALSE(other_.lives());
  other_.lost();
  connect(start_ + 20s);
  EXPECT_TRUE(kept(health(kOther, "2026-01-02T03:00:10.000Z"), start_ + 20s)) << "its clock is late, but it runs";
}

TEST_F(OtherGatewayTest, WhatABridgeBetweenBrokersBringsOfOurLastLifeIsNone) {
  connect(start_);
  kept(health(kOther, "2026-01-02T03:04:05.678Z"), start_);
  live(health(kOther, "2026-01-02T03:04:05.678Z"), start_ + 1s);
  live(health(kOther, "2026-01-02T03:03:35.678Z"), start_ + 1s);
  other_.heard({.topic = "canopen/line3/info", .payload = R"({"instance":"bbbb000011112222"})"}, start_ + 1s);
  EXPECT_FALSE(other_.lives());
  live(health(kOther, "2026-01-02T03:04:35.678Z"), start_ + 31s);
  EXPECT_TRUE(other_.lives());
}

TEST_F(OtherGatewayTest, AConnectionThatBrokeBeforeAnythingWasPublishedIsNotTheFirst) {
  other_.connected("b:1883");
  other_.lost();
  connect(start_ + 1s);
  EXPECT_FALSE(kept(health(kOther), start_ + 1s));
  other_.lost();
  connect(start_ + 2s, "other:1883");
  EXPECT_FALSE(kept(health(kOther), start_ + 2s)) << "each broker has its own past";
}

TEST_F(OtherGatewayTest, ATakeOverIsOneToo) {
  connect(start_);
  other_.took_over(start_);
  other_.lost();
  EXPECT_EQ(other_.who(), OtherGateway::kUnknown);
  EXPECT_NE(notices_.at(0).find("client id"), std::string::npos) << notices_[0];
  connect(start_ + 60s);
  live(health(kOther), start_ + 61s);
  EXPECT_EQ(other_.who(), kOther);
  EXPECT_EQ(changes_, 2);
  EXPECT_EQ(notices_.size(), 1U) << "it is the same condition";
}

TEST_F(OtherGatewayTest, WhatIsNoHealthSaysNothing) {
  connect(start_);
  std::string deep;
  for (int i = 0; i < 9000; ++i) {
    deep += R"({"instance":)";
  }
  const std::vector<std::string> all{
      "",
      "x",
      "null",
      "[]",
      "{}",
      R"({"instance":null})",
      R"({"instance":7})",
      R"({"instance":""})",
      R"({"instance":"a b"})",
      R"({"instance":"a\nb"})",
      R"({"instance":"bbbb")",
      R"({"x":{"instance":"bbbb"}})",
      R"({"instance":")" + std::string(65, 'b') + R"("})",
      deep,
      std::string(1000, '['),
      R"({"instance":"bbbb","x":")" + std::string(200'000, 'x') + R"("})",
      std::string("\xff\xfe\0{", 4),
  };
  for (const std::string& payload : all) {
    EXPECT_FALSE(live(payload, start_)) << payload.substr(0, 50);
    EXPECT_FALSE(other_.lives()) << payload.substr(0, 50);
  }
}

}  // namespace
}  // namespace mqtt
