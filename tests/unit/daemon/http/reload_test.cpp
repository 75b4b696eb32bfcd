// What HTTP shows while the configuration changes.
#include <gmock/gmock.h>

#include "config/difference.h"
#include "tests/unit/daemon/http/shown_plant.h"

namespace gateway::http {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class HttpReload : public test::ShownPlant {
 protected:
  HttpReload() {
    gateway_.plant().add(history_);
    history_.start();
  }
  ~HttpReload() override { history_.stop(); }

  /// The drives of now in another order, and without pump1.
  void change() {
    auto next = std::make_shared<config::Model>(model_);
    std::swap(next->drives.front(), next->drives.back());
    next->drives.erase(next->drives.begin() + static_cast<std::ptrdiff_t>(*config::find_named(next->drives, "pump1")));
    const auto changed = support::spawn(loop_.executor(), gateway_.change(next));
    ASSERT_TRUE(loop_.advance_until([&] { return *changed; }, 5s));
  }
  std::string finish(Answer& answer) {
    while (answer.rest && answer.rest(answer.body).goes_on) {
    }
    return std::string(answer.text());
  }
};

TEST_F(HttpReload, AReaderOfTheStreamIsToldOfAllThatThereIsNow) {
  Live::Place place = live_.begin();
  const auto take = [&] { return live_.take(place, [] { return std::string("{}"); }); };
  (void)take();
  change();
  const std::string events = take();
  EXPECT_THAT(events, AllOf(HasSubstr("{\"name\":\"fan1\""), HasSubstr("{\"name\":\"mixer1\""),
                            Not(HasSubstr("{\"name\":\"pump1\""))));
  EXPECT_EQ(take(), "");
}

TEST_F(HttpReload, TheTrendOfADriveThatStaysGoesOn) {
  loop_.advance(5s);
  const std::size_t before = json("/api/history?drive=mixer1").at("samples").as_array().size();
  change();
  loop_.advance(3s);
  const boost::json::value trend = json("/api/history?drive=mixer1");
  EXPECT_GE(trend.at("samples").as_array().size(), before + 2);
  EXPECT_EQ(trend.at("drive").as_string(), "mixer1");
  EXPECT_FALSE(trend.at("samples").as_array().front().as_array().back().is_null());
  EXPECT_EQ(get("/api/history?drive=pump1").status, 404U);
}

TEST_F(HttpReload, WhatIsBeingToldIsToldToItsEnd) {
  for (const std::string target :
       {"/api/drives", "/api/history?drive=pump1", "/api/buses", "/api/alarms", "/metrics"}) {
    const auto original = std::make_shared<config::Model>(model_);
    Answer answer = begin(target);
    const bool more = answer.rest && answer.rest(answer.body).goes_on;
    change();
    const std::string text = more ? finish(answer) : std::string(answer.text());
    if (target != "/metrics") {
      EXPECT_NO_THROW((void)boost::json::parse(text)) << target << ": " << text;
    }
    const auto back = support::spawn(loop_.executor(), gateway_.change(original));
    ASSERT_TRUE(loop_.advance_until([&] { return *back; }, 5s));
  }
  loop_.advance(10s);
  EXPECT_EQ(gateway_.plant().online(), 4U);
}

TEST_F(HttpReload, CommandsOfADriveThatStaysAreStillCounted) {
  EXPECT_FALSE(set("mixer1", "target_velocity", 100).has_error());
  change();
  EXPECT_FALSE(set("mixer1", "target_velocity", 200).has_error());
  EXPECT_THAT(text("/metrics"), HasSubstr("commands_total{drive=\"mixer1\",writer=\"local\",outcome=\"ok\"} 2"));
}

}  // namespace
}  // namespace gateway::http
