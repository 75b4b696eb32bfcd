// What a broker is told to do after a time, when nobody is there any more. In real time, for a broker has no other.

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <string>
#include <utility>

#include "tests/unit/mqtt/on_mosquitto.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;

constexpr const char* kGatewayStatus = "canopen/line3/status";

// Breaks the connection of this process to that port as a network does, without a goodbye.
void cut(std::uint16_t port) {
  constexpr int kDescriptors = 256;
  int cut = 0;
  for (int descriptor = 3; descriptor < kDescriptors; ++descriptor) {
    sockaddr_in peer{};
    socklen_t length = sizeof(peer);
    if (getpeername(descriptor, reinterpret_cast<sockaddr*>(&peer), &length) == 0 && peer.sin_family == AF_INET &&
        ntohs(peer.sin_port) == port) {
      cut += shutdown(descriptor, SHUT_RDWR) == 0 ? 1 : 0;
    }
  }
  ASSERT_EQ(cut, 1);
}

class BrokerTime : public test::OnMosquitto {
 protected:
  void go_online(PublisherSettings made) {
    make(std::move(made));
    ASSERT_TRUE(connected());
    publisher->publish({{.topic = kGatewayStatus, .payload = "online"}});
    open();
    ASSERT_TRUE(is_retained(kGatewayStatus, "online"));
  }
};

struct Delays {
  std::chrono::seconds will;
  std::chrono::seconds session;
};

class Wills : public BrokerTime, public testing::WithParamInterface<Delays> {};

TEST_P(Wills, AreSaidByTheBrokerAfterTheShorterDelay) {
  PublisherSettings made = settings(broker_.port());
  made.client.will_delay = GetParam().will;
  made.client.session_expiry = GetParam().session;
  made.first_pause = 60s;
  made.longest_pause = 60s;
  go_online(std::move(made));
  const auto begun = Clock::now();
  cut(broker_.port());
  ASSERT_TRUE(run_until([this] { return disconnections == 1; }));
  EXPECT_TRUE(is_retained(kGatewayStatus, "offline"));
  EXPECT_GE(Clock::now() - begun, 900ms) << "mosquitto counts whole seconds";
}

INSTANTIATE_TEST_SUITE_P(Each, Wills, testing::Values(Delays{2s, 60s}, Delays{60s, 2s}));

TEST_F(BrokerTime, WhoComesBackIsOnlineForGoodAndWhatExpiresIsGone) {
  PublisherSettings made = settings(broker_.port());
  made.client.will_delay = 1s;
  go_online(std::move(made));
  cut(broker_.port());
  ASSERT_TRUE(connected(2));
  ASSERT_TRUE(subscribe({{.filter = kGatewayStatus, .watched = true, .own_too = true}}));
  publisher->publish({{.topic = kGatewayStatus, .payload = "online"},
                      {.topic = "state", .payload = "live", .expiry = 2},
                      {.topic = "info", .payload = "kept"}});
  open();
  ASSERT_TRUE(run_until([this] { return retained("state") == "1 live\n"; }));
  EXPECT_TRUE(run_until([this] { return retained("state").empty(); }));
  EXPECT_EQ(retained("info"), "1 kept\n");
  EXPECT_EQ(retained(kGatewayStatus), "1 online\n") << "the delay of the will has run out by now";
  for (const Incoming& message : messages) {
    EXPECT_EQ(message.payload, "online");
  }
}

}  // namespace
}  // namespace mqtt
