#include "bridges/mqtt/traffic.h"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <string>
#include <vector>

namespace mqtt {
namespace {

using namespace std::chrono_literals;

/// What the publisher's threads would do, done by hand.
class TrafficTest : public testing::Test {
 protected:
  void connect(BrokerLimits limits) {
    const auto connection = traffic_.begin();
    ASSERT_TRUE(connection);
    traffic_.on_up(limits);
    traffic_.open(*connection);
  }
  void publish(int count) {
    std::vector<Message> batch;
    for (int i = 0; i < count; ++i) {
      batch.push_back({.topic = "t/" + std::to_string(i), .payload = "1"});
    }
    traffic_.publish(std::move(batch));
  }

  boost::asio::io_context context_;
  std::vector<std::string> said_;
  std::shared_ptr<LoopPost> loop_ = std::make_shared<LoopPost>(context_.get_executor(), [this](LoopEvent& event) {
    if (const auto* said = std::get_if<Said>(&event)) {
      said_.push_back(said->text);
    }
  });
  Traffic traffic_{1000, loop_};
};

TEST_F(TrafficTest, ARefusedMessageFreesItsPlace) {
  connect({.window = 10});
  publish(100);
  for (int round = 0; round < 10; ++round) {
    const Traffic::Work work = traffic_.await_work();
    ASSERT_EQ(work.messages.size(), 10U) << round;
    for (const auto& [message, in_flight] : work.messages) {
      traffic_.on_sent(in_flight, Delivery::refused);
    }
  }
  traffic_.finish({}, 10s);
  EXPECT_TRUE(traffic_.await_work().farewell) << "nothing is left under way";
  context_.poll();
  ASSERT_EQ(said_.size(), 1U) << "said once";
  EXPECT_NE(said_[0].find("refuses some"), std::string::npos);
}

TEST_F(TrafficTest, NoMoreIsUnderWayThanTheBrokerTakes) {
  connect({.window = 3});
  publish(5);
  const Traffic::Work first = traffic_.await_work();
  ASSERT_EQ(first.messages.size(), 3U);
  traffic_.on_sent(first.messages[1].second, Delivery::done);
  const Traffic::Work second = traffic_.await_work();
  ASSERT_EQ(second.messages.size(), 1U);
  EXPECT_EQ(second.messages[0].first.topic, "t/3");
}

}  // namespace
}  // namespace mqtt
