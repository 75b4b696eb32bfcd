// Whether a broker that is not in use lives, and would take us.

#include "bridges/mqtt/reach.h"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <string>

#include "tests/support/mosquitto.h"
#include "tests/unit/mqtt/on_mosquitto.h"
#include "tests/unit/mqtt/tiny_broker.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using support::Mosquitto;
using test::TinyBroker;

TEST(Reach, ABrokerThatLivesIsReachedAndOneThatStandsStillIsNot) {
  Mosquitto broker;
  ASSERT_TRUE(broker.start());
  const config::Endpoint at{"127.0.0.1", broker.port()};
  EXPECT_TRUE(reaches(at, {"127.0.0.1"}, {}, 2s).good);
  EXPECT_TRUE(takes_us(at, {"127.0.0.1"}, {.client_id = "a"}, 0, 2s).good);
  broker.freeze();
  EXPECT_FALSE(reaches(at, {"127.0.0.1"}, {}, 300ms).good);
  const Reach trial = takes_us(at, {"127.0.0.1"}, {.client_id = "a"}, 0, 300ms);
  EXPECT_FALSE(trial.good);
  EXPECT_EQ(trial.why, "no answer");
  broker.resume();
  broker.stop();
  EXPECT_FALSE(reaches(at, {"127.0.0.1"}, {}, 300ms).good);
  EXPECT_FALSE(reaches(at, {}, {}, 300ms).good);
}

TEST(Reach, ATrialTellsWhyItWasRefused) {
  TinyBroker broker({.refusal = 5});
  const Reach trial = takes_us({"127.0.0.1", broker.port()}, {"127.0.0.1"}, {.client_id = "a"}, 4, 2s);
  EXPECT_FALSE(trial.good);
  EXPECT_NE(trial.why.find("uthori"), std::string::npos) << trial.why;
}

TEST(Reach, ATrialGoesOnWithAnOlderVersionWhereTheBrokerClosesOnTheNewOne) {
  TinyBroker broker({.closes_on_5 = true});
  const config::Endpoint at{"127.0.0.1", broker.port()};
  EXPECT_TRUE(takes_us(at, {"127.0.0.1"}, {.client_id = "a"}, 0, 2s).good);
  EXPECT_FALSE(takes_us(at, {"127.0.0.1"}, {.client_id = "a"}, 5, 2s).good);
}

TEST(Reach, TheQuestionEndsNoSessionOfOurClientId) {
  Mosquitto broker;
  ASSERT_TRUE(broker.start());
  const std::string at = " -h 127.0.0.1 -p " + std::to_string(broker.port());
  auto heard = std::async(std::launch::async, [&at] {
    return test::output_of("mosquitto_sub -i canopen-gateway-line3 -W 5 -C 1 -t a" + at + " 2>&1");
  });
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(reaches({"127.0.0.1", broker.port()}, {"127.0.0.1"}, {}, 2s).good);
  }
  while (heard.wait_for(50ms) != std::future_status::ready) {
    (void)test::output_of("mosquitto_pub -t a -m x" + at);
  }
  EXPECT_EQ(heard.get(), "x\n");
}

}  // namespace
}  // namespace mqtt
