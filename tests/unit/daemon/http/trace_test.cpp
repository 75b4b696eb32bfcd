// The trace by HTTP, of a whole gateway.

#include <gmock/gmock.h>

#include <list>
#include <memory>
#include <string>

#include "bridges/trace/feed.h"
#include "daemon/http/event_source.h"
#include "tests/support/bus_fixture.h"
#include "tests/unit/daemon/demo_model.h"
#include "tests/unit/daemon/demo_plant.h"
#include "tests/unit/daemon/http/raw_client.h"
#include "tests/unit/daemon/http/shown_plant.h"

namespace gateway::http {
namespace {

using namespace std::chrono_literals;
using test::RawClient;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

config::Model http_model() {
  config::Model model = gateway::test::demo_model();
  model.modbus.reset();
  model.mqtt.reset();
  model.gateway.control.clear();
  model.http->listen.port = 0;
  return model;
}

class HttpTrace : public gateway::test::DemoPlant {
 protected:
  HttpTrace() : DemoPlant(http_model()) { begin_plant(); }
  ~HttpTrace() override { end_plant(); }

  RawClient& get(std::string_view target) {
    RawClient& client = clients_.emplace_back(gateway_.http_port());
    loop_.settle();
    client.get(target);
    loop_.settle();
    return client;
  }

  std::list<RawClient> clients_;
};

TEST_F(HttpTrace, ShowsTheFramesOfADriveAsTheyCome) {
  RawClient& client = get("/api/trace?drive=pump1");
  EXPECT_THAT(client.received(), HasSubstr("\r\nContent-Type: text/event-stream\r\n"));
  loop_.advance(1s);
  const std::string got = client.received();
  EXPECT_THAT(got,
              AllOf(HasSubstr("event: frame\ndata: {\"ts\":\""), HasSubstr("\"owner\":\"pump1\",\"name\":\"TPDO1\""),
                    HasSubstr("\"text\":\"operational\""), Not(HasSubstr("fan1"))));
  clients_.clear();
  loop_.advance(1s);
}

TEST_F(HttpTrace, KindsCanBeChosen) {
  RawClient& client = get("/api/trace?drive=pump1&kind=heartbeat");
  loop_.advance(1s);
  EXPECT_THAT(client.received(), AllOf(HasSubstr("\"kind\":\"heartbeat\""), Not(HasSubstr("\"kind\":\"pdo\""))));
}

TEST_F(HttpTrace, SaysWhatThereIsNot) {
  EXPECT_THAT(get("/api/trace?drive=pump9").received(),
              AllOf(HasSubstr(" 404 "), HasSubstr("there is no drive \\\"pump9\\\""), HasSubstr("\"mixer1\"")));
  EXPECT_THAT(get("/api/trace?kind=tpdo").received(),
              AllOf(HasSubstr(" 400 "), HasSubstr("no kind of frames \\\"tpdo\\\"")));
  EXPECT_THAT(get("/api/trace?since=1").received(), HasSubstr(" 400 "));
}

class HttpTraceEvents : public test::ShownPlant {};

// He takes nothing for a while: what he lost is counted.
TEST_F(HttpTraceEvents, ASlowReaderLosesFramesCounted) {
  canopen::LinkEvents* events = nullptr;
  canopen::Bus bus(loop_.executor(), std::make_unique<support::HandLink>(events), support::kQuiet);
  bus.start();
  events->on_bus_state({canopen::BusCondition::error_active, 0, 0});
  trace::Feed feed(model_, {&bus});
  site_.trace = &feed;
  const Answer answer = begin("/api/trace?drive=pump1&kind=heartbeat");
  ASSERT_TRUE(answer.stream);
  ASSERT_TRUE(answer.events);
  EXPECT_EQ(feed.readers(), 0U) << "nobody has begun";
  {
    const std::unique_ptr<EventSource> source = answer.events();
    const canopen::Received received{support::frame(0x705, 5), canopen::Clock::now(), canopen::wall_now()};
    for (std::size_t i = 0; i < trace::Feed::kKept + 7; ++i) {
      events->on_frames({&received, 1});
    }
    std::string told;
    EXPECT_TRUE(source->take(told)) << "a piece of them";
    EXPECT_THAT(told, testing::StartsWith("event: lost\ndata: {\"frames\":7}\n\nevent: frame\ndata: {\"ts\":"));
    EXPECT_LT(told.size(), Live::kMostBytes);
    while (source->take(told)) {
    }
    told.clear();
    EXPECT_FALSE(source->take(told));
    EXPECT_EQ(told, "");
  }
  EXPECT_EQ(feed.readers(), 0U);
  site_.trace = nullptr;
}

}  // namespace
}  // namespace gateway::http
