#include "bridges/mqtt/broker_addresses.h"

#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using Addresses = std::vector<std::string>;

constexpr auto kAnswersWithin = 20s;

/// Of the questions' threads too, which nobody waits for.
struct NameServer {
  std::mutex mutex;
  Addresses answer{"192.0.2.1"};
  int questions = 0;
  std::shared_future<void> answers;  ///< Valid: not before that.
};

class BrokerAddressesTest : public testing::Test {
 protected:
  [[nodiscard]] BrokerAddresses make(const std::string& host, bool tls = false) const {
    return {{.host = host, .port = 1883, .tls = tls}, [server = server_](const config::Endpoint&) {
              std::unique_lock lock(server->mutex);
              ++server->questions;
              const Addresses answer = server->answer;
              const std::shared_future<void> answers = server->answers;
              lock.unlock();
              if (answers.valid()) {
                answers.wait();
              }
              return answer;
            }};
  }
  [[nodiscard]] static bool ask(BrokerAddresses& addresses) {
    addresses.ask();
    return addresses.is_answered(kAnswersWithin);
  }
  void answer(Addresses with) {
    const std::lock_guard lock(server_->mutex);
    server_->answer = std::move(with);
  }
  /// Until the promise is kept, or goes.
  [[nodiscard]] std::promise<void> fall_silent() {
    std::promise<void> release;
    const std::lock_guard lock(server_->mutex);
    server_->answers = release.get_future().share();
    return release;
  }
  [[nodiscard]] int questions() const {
    const std::lock_guard lock(server_->mutex);
    return server_->questions;
  }

  std::shared_ptr<NameServer> server_ = std::make_shared<NameServer>();
  BrokerAddresses::TimePoint now_{1h};
};

TEST_F(BrokerAddressesTest, AreWhatTheNameHas) {
  BrokerAddresses addresses = make("broker.example");
  EXPECT_FALSE(addresses.can_do_without());
  EXPECT_TRUE(addresses.to_try().empty());
  ASSERT_TRUE(ask(addresses));
  EXPECT_EQ(addresses.to_try(), Addresses{"192.0.2.1"});
  EXPECT_TRUE(addresses.are_new());
  answer({"192.0.2.2", "192.0.2.3"});
  ASSERT_TRUE(ask(addresses));
  EXPECT_EQ(addresses.to_try(), (Addresses{"192.0.2.2", "192.0.2.3"}));
}

TEST_F(BrokerAddressesTest, OfLastTimeAreTriedWhereNobodyAnswersOrNothingIsFound) {
  BrokerAddresses addresses = make("broker.example");
  ASSERT_TRUE(ask(addresses));
  answer({});
  ASSERT_TRUE(ask(addresses));
  EXPECT_FALSE(addresses.are_new());
  EXPECT_EQ(addresses.to_try(), Addresses{"192.0.2.1"});
  std::promise<void> release = fall_silent();
  addresses.ask();
  EXPECT_TRUE(addresses.can_do_without());
  EXPECT_FALSE(addresses.is_answered());
  EXPECT_FALSE(addresses.are_new());
  EXPECT_EQ(addresses.to_try(), Addresses{"192.0.2.1"});
}

// Paho would look the name up itself, and hold up everything else.
TEST_F(BrokerAddressesTest, WithTlsTheNameIsGivenAwayOnlyWhereItWasAnsweredJustNow) {
  BrokerAddresses addresses = make("broker.example", true);
  ASSERT_TRUE(ask(addresses));
  EXPECT_EQ(addresses.to_try(), Addresses{"broker.example"});
  EXPECT_EQ(addresses.known(), Addresses{"192.0.2.1"});
  EXPECT_FALSE(addresses.can_do_without());
  std::promise<void> release = fall_silent();
  addresses.ask();
  EXPECT_FALSE(addresses.is_answered());
  EXPECT_TRUE(addresses.to_try().empty());
  EXPECT_EQ(addresses.known(), Addresses{"192.0.2.1"}) << "for the search for mistakes";
}

TEST_F(BrokerAddressesTest, AreAskedForAheadNowAndThen) {
  BrokerAddresses addresses = make("broker.example");
  addresses.ask_ahead(now_);
  ASSERT_TRUE(addresses.is_answered(kAnswersWithin));
  EXPECT_TRUE(addresses.can_do_without());
  addresses.ask_ahead(now_ + BrokerAddresses::kAhead - 1s);
  EXPECT_EQ(questions(), 1);
  addresses.ask_ahead(now_ + BrokerAddresses::kAhead);
  ASSERT_TRUE(addresses.is_answered(kAnswersWithin));
  EXPECT_EQ(questions(), 2);
}

TEST_F(BrokerAddressesTest, ANameServerThatHangsIsAskedOnceAtATime) {
  BrokerAddresses addresses = make("broker.example");
  std::promise<void> release = fall_silent();
  addresses.ask_ahead(now_);
  addresses.ask();
  addresses.ask_ahead(now_ + 24h);
  EXPECT_FALSE(addresses.is_answered());
  release.set_value();
  ASSERT_TRUE(addresses.is_answered(kAnswersWithin));
  EXPECT_EQ(questions(), 1);
}

TEST_F(BrokerAddressesTest, AreNotAskedForAheadWhereThatIsOfNoUse) {
  BrokerAddresses tls = make("broker.example", true);
  tls.ask_ahead(now_);
  EXPECT_EQ(questions(), 0) << "Paho asks itself";
  BrokerAddresses numeric = make("192.0.2.1");
  ASSERT_TRUE(ask(numeric));
  numeric.ask_ahead(now_);
  ASSERT_TRUE(numeric.is_answered(kAnswersWithin));
  EXPECT_EQ(questions(), 1) << "an address is its own name";
}

TEST_F(BrokerAddressesTest, OfIpv4AndOfIpv6AreOneMachine) {
  struct Case {
    Addresses found;
    bool several;
  };
  for (const Case& each :
       {Case{{"192.0.2.1"}, false}, Case{{"::1", "127.0.0.1"}, false}, Case{{"192.0.2.1", "192.0.2.2"}, true},
        Case{{"2001:db8::1", "2001:db8::2"}, true}, Case{{"2001:db8::1", "192.0.2.1", "192.0.2.2"}, true}}) {
    BrokerAddresses addresses = make("broker.example");
    EXPECT_FALSE(addresses.are_of_several()) << "none is known";
    answer(each.found);
    ASSERT_TRUE(ask(addresses));
    EXPECT_EQ(addresses.are_of_several(), each.several) << testing::PrintToString(each.found);
  }
}

}  // namespace
}  // namespace mqtt
