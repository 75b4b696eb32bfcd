// Brokers by name: which of its addresses are tried, for how long, and what becomes of it where the name server is
// silent.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/mosquitto.h"
#include "tests/unit/mqtt/brokers_fixture.h"
#include "tests/unit/mqtt/first_words.h"
#include "tests/unit/mqtt/tiny_broker.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using support::Mosquitto;
using test::Brokers;
using test::FirstWords;
using test::kOverWithin;
using test::TinyBroker;
using test::TwoBrokers;

TEST_F(Brokers, AFirstOneThatNobodyAnswersAtIsPassedOverWithAllItsAddresses) {
  FirstWords one;
  ASSERT_TRUE(one.fill());
  FirstWords other("127.0.0.2", one.port());
  ASSERT_TRUE(other.fill());
  Mosquitto second;
  ASSERT_TRUE(second.start());
  PublisherSettings made = of({one.port(), second.port()});
  made.brokers[0].host = "first.example";
  made.resolver = [](const config::Endpoint& endpoint) {
    return endpoint.host == "first.example" ? std::vector<std::string>{"127.0.0.1", "127.0.0.2"}
                                            : std::vector<std::string>{endpoint.host};
  };
  make(std::move(made));
  EXPECT_TRUE(is_in_use(second.port()));
}

TEST_F(Brokers, AFirstOneWithManyAddressesDoesNotHoldUpTheSecondForLonger) {
  FirstWords first("0.0.0.0");
  ASSERT_TRUE(first.fill());
  Mosquitto second;
  ASSERT_TRUE(second.start());
  PublisherSettings made = of({first.port(), second.port()});
  made.brokers[0].host = "first.example";
  made.turn = 1500ms;
  made.resolver = [](const config::Endpoint& endpoint) {
    std::vector<std::string> found;
    for (int i = 1; i <= 20; ++i) {
      found.push_back("127.0.0." + std::to_string(i));
    }
    return endpoint.host == "first.example" ? found : std::vector<std::string>{endpoint.host};
  };
  make(std::move(made));
  EXPECT_TRUE(is_in_use(second.port())) << "each of them has a second at least";
}

// Its name is asked for while the first one is in use. Its look-up of later, which hangs, is not waited for.
TEST_F(TwoBrokers, ANameServerThatFellSilentMeanwhileKeepsNobodyFromTheSecond) {
  auto asked = std::make_shared<std::promise<void>>();
  std::promise<void> release;
  PublisherSettings made = of({first_.port(), second_.port()});
  made.brokers[1].host = "second.example";
  made.hurried = 60s;
  made.resolver = [asked, times = std::make_shared<std::atomic<int>>(0),
                   released = release.get_future().share()](const config::Endpoint& endpoint) {
    if (endpoint.host == "second.example" && ++*times > 1) {
      asked->set_value();
      released.wait();
    }
    return std::vector<std::string>{"127.0.0.1"};
  };
  make(std::move(made));
  ASSERT_TRUE(is_in_use(first_.port()));
  first_.stop();
  EXPECT_TRUE(run_until([&] { return connections.size() > disconnections && used.back() == second_name(); }));
  EXPECT_EQ(asked->get_future().wait_for(0s), std::future_status::ready) << "it was asked anew";
  EXPECT_TRUE(is_said("connected to " + second_name() + " at 127.0.0.1, its last known address"))
      << testing::PrintToString(notices);
  release.set_value();
}

TEST_F(Brokers, AFirstOneWhoseNameIsNotAnsweredIsPassedOver) {
  Mosquitto second;
  ASSERT_TRUE(second.start());
  std::promise<void> release;
  PublisherSettings made = of({1, second.port()});
  made.brokers[0].host = "first.example";
  made.resolver = [released = release.get_future().share()](const config::Endpoint& endpoint) {
    if (endpoint.host == "first.example") {
      released.wait();
    }
    return std::vector<std::string>{"127.0.0.1"};
  };
  make(std::move(made));
  EXPECT_TRUE(is_in_use(second.port()));
  release.set_value();
}

TEST_F(Brokers, AnAddressThatFallsSilentIsFollowedByTheNextOfItsName) {
  Mosquitto one;
  ASSERT_TRUE(one.start());
  PublisherSettings made = of({one.port()});
  made.brokers.front().host = "broker.example";
  made.resolver = [](const config::Endpoint&) { return std::vector<std::string>{"127.0.0.1", "127.0.0.2"}; };
  make(std::move(made));
  ASSERT_TRUE(connected());
  one.freeze();
  const FirstWords next("127.0.0.2", one.port());
  EXPECT_TRUE(run_until([&next] { return next.has_client(); }, kOverWithin));
}

// As `localhost` has them: there is no other machine, so it has all the time of one that is alone.
TEST_F(Brokers, ANameWithAnAddressOfEitherKindIsNotAskedWhetherItLives) {
  TinyBroker broker({.speaks_5 = true});
  PublisherSettings made = of({broker.port()});
  made.resolver = [](const config::Endpoint&) { return std::vector<std::string>{"127.0.0.1", "::1"}; };
  made.quiet = 50ms;
  made.client.keep_alive = 1s;
  make(std::move(made));
  ASSERT_TRUE(connected());
  EXPECT_TRUE(run_until([&broker] { return broker.pings() >= 2; })) << "which Paho asks by itself";
  EXPECT_EQ(broker.unsubscribes(), 0);
}

// As a name server that changes the order, where a cluster has one name.
TEST_F(Brokers, ATopicThatTheBrokerClosesOnIsHeldBackThoughItsAddressIsAnotherOneEachTime) {
  TinyBroker broker({.speaks_5 = true, .hates = "bad"});
  PublisherSettings made = settings(broker.port());
  made.brokers.front().host = "broker.example";
  made.resolver = [times = std::make_shared<std::atomic<int>>(0)](const config::Endpoint&) {
    return std::vector<std::string>{++*times % 2 == 0 ? "127.0.0.1" : "::ffff:127.0.0.1"};
  };
  make(std::move(made));
  std::size_t opened = 0;
  EXPECT_TRUE(run_until([&] {
    if (connections.size() > opened) {  // as the bridge does: everything again
      opened = connections.size();
      publisher->publish({{.topic = "bad", .payload = "1"}, {.topic = "good", .payload = "1"}});
    }
    return is_said("where bad is published") && std::ranges::count(broker.published(), "good=1") > 0;
  }));
  EXPECT_LE(connections.size(), 3U);
}

}  // namespace
}  // namespace mqtt
