#pragma once

#include <gtest/gtest.h>

#include <boost/json/parse.hpp>
#include <deque>
#include <string>
#include <string_view>

#include "bridges/process/command.h"
#include "daemon/http/history.h"
#include "daemon/http/live.h"
#include "daemon/http/respond.h"
#include "daemon/map.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/demo_model.h"
#include "tests/unit/daemon/demo_plant.h"

namespace gateway::http::test {

using namespace std::chrono_literals;

inline config::Model shown_model() {
  config::Model model = gateway::test::demo_model();
  model.modbus.reset();
  model.mqtt.reset();
  model.http.reset();
  model.gateway.control.clear();
  return model;
}

/// The demo's drives, and what HTTP shows of them.
class ShownPlant : public gateway::test::DemoPlant {
 protected:
  ShownPlant() : DemoPlant(shown_model()) {
    gateway_.plant().add(tally_);
    gateway_.plant().add(live_);
    begin_plant();
  }
  ~ShownPlant() override { end_plant(); }

  Answer begin(std::string_view target) {
    return respond({.target = std::get<Target>(parse_target(target)), .host = "localhost"}, site_);
  }
  /// With all of its text.
  Answer get(std::string_view target) {
    Answer answer = begin(target);
    while (answer.rest && answer.rest(answer.body).goes_on) {
    }
    return answer;
  }
  std::string text(std::string_view target) {
    const Answer answer = get(target);
    EXPECT_EQ(answer.status, 200U) << target << ": " << answer.text();
    return std::string(answer.text());
  }
  boost::json::value json(std::string_view target) { return boost::json::parse(text(target)); }
  process::Outcome set(const char* drive, const char* signal, double value) {
    process::Drive& asked = *gateway_.plant().find(drive);
    const auto id = static_cast<process::SignalId>(asked.model().find(signal).value());
    const auto outcome = support::spawn(
        loop_.executor(), asked.write({.writer = {.way = process::Writer::Way::local, .address = {}}}, {{id, value}}));
    EXPECT_TRUE(loop_.advance_until([&] { return outcome.done(); }, 5s));
    return outcome.get();
  }

  CommandTally tally_;
  std::deque<std::string> journal_;
  Live live_{gateway_.plant()};
  History history_{loop_.executor(), gateway_.plant()};
  Site site_{.plant = gateway_.plant(),
             .commands = tally_,
             .version = "1.2.3",
             .map = std::make_shared<const std::string>(render_map_json(model_)),
             .health = [this] { return gateway_.health(); },
             .history = [this](std::size_t drive) { return history_.json(drive); },
             .survey = [this](std::size_t bus) -> const canopen::BusSurvey& { return gateway_.survey(bus); }};
};

}  // namespace gateway::http::test
