// Whether a broker that is not in use lives, and would take us.

#include "bridges/mqtt/reach.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <string>

#include "tests/support/mosquitto.h"
#include "tests/unit/mqtt/first_words.h"
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
  const Reach reach = reaches(at, {"127.0.0.1"}, {}, 2s);
  EXPECT_TRUE(reach.good);
  EXPECT_EQ(reach.manner, Manner::connack);
  EXPECT_FALSE(speaks_tls(at, {"127.0.0.1"}, 2s));
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

// What a look for a broker comes to where this is said, and the connection closed.
Reach reach_of(const std::string& words) {
  const test::FirstWords port;
  auto reach = std::async(std::launch::async, [at = config::Endpoint{"127.0.0.1", port.port()}] {
    return reaches(at, {"127.0.0.1"}, {}, 10s);
  });
  const int client = port.take();
  EXPECT_EQ(send(client, words.data(), words.size(), MSG_NOSIGNAL), static_cast<ssize_t>(words.size()));
  shutdown(client, SHUT_WR);
  Reach result = reach.get();
  close(client);
  return result;
}

TEST(Reach, WhatSpeaksAnotherProtocolIsNoBroker) {
  const std::string tls_alert{0x15, 0x03, 0x01, 0x00, 0x02, 0x02, 0x46};
  for (const std::string& words :
       {std::string("SSH-2.0-OpenSSH_9.2p1\r\n"), std::string("HTTP/1.1 400\r\n"), tls_alert}) {
    const Reach reach = reach_of(words);
    EXPECT_FALSE(reach.good) << words;
    EXPECT_EQ(reach.manner, Manner::foreign) << words;
    EXPECT_EQ(reach.why, "what answers there is no MQTT broker");
  }
}

TEST(Reach, WhatRefusesTheVersionLivesInWhateverManner) {
  const std::string connack{0x20, 0x02, 0x00, 0x01};
  const std::string disconnect{static_cast<char>(0xE0), 0x02, static_cast<char>(0x84), 0x00};
  EXPECT_EQ(reach_of(connack).manner, Manner::connack);
  EXPECT_EQ(reach_of(disconnect).manner, Manner::closes);
  EXPECT_EQ(reach_of("").manner, Manner::closes);
  for (const std::string& words : {connack, disconnect, std::string()}) {
    EXPECT_TRUE(reach_of(words).good);
  }
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
