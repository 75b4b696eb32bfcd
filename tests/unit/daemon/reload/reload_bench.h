#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "daemon/reload/reload.h"
#include "tests/unit/daemon/demo_model.h"
#include "tests/unit/daemon/demo_plant.h"

namespace gateway {

using namespace std::chrono_literals;

inline config::Model quiet_model() {
  config::Model model = test::demo_model();
  model.modbus.reset();
  model.mqtt.reset();
  model.http.reset();
  model.recorder.reset();
  model.gateway.control.clear();
  return model;
}

/// The gateway with the demo's drives: fan1, pump1, hoist1, mixer1.
class ReloadTest : public test::DemoPlant {
 protected:
  explicit ReloadTest(config::Model model = quiet_model()) : DemoPlant(std::move(model)), file_(model_) {
    begin_plant();
    reload_.start();
    loop_.settle();
  }
  ~ReloadTest() override {
    const auto stopped = support::spawn(loop_.executor(), reload_.stop());
    await([&] { return *stopped; });
    end_plant();
  }

  /// The thread has its own time.
  template <class Predicate>
  void await(Predicate done) {
    for (int i = 0; i < 2000 && !done(); ++i) {
      loop_.context().run_one_for(10ms);
    }
    ASSERT_TRUE(done());
  }
  /// What the file holds now is wanted.
  void reload() {
    const int before = ends_;
    reload_.request();
    await([&] { return ends_ > before; });
  }
  void write(std::size_t drive, const std::vector<std::pair<std::string, double>>& values) {
    process::Drive& written = gateway_.plant().drive(drive);
    std::vector<process::FieldWrite> fields;
    for (const auto& [name, value] : values) {
      fields.push_back({static_cast<process::SignalId>(written.model().find(name).value()), value});
    }
    const auto answer = support::spawn(
        loop_.executor(),
        written.write({.writer = {.way = process::Writer::Way::local, .address = {}}}, std::move(fields)));
    ASSERT_TRUE(loop_.advance_until([&] { return answer.done(); }, 2s));
    ASSERT_FALSE(answer.get().has_error()) << answer.get().error().detail;
  }
  void run_fan() {
    write(0, {{"frequency_command", 30.0}, {"torque_command", 0.0}, {"control_command", 1.0}});
    ASSERT_TRUE(loop_.advance_until([&] { return drive("fan1").image().raw(running_of("fan1")) != 0; }, 5s));
  }
  void stop_fan() { write(gateway_.plant().find("fan1")->index(), {{"control_command", 5.0}}); }
  [[nodiscard]] process::Drive& drive(const std::string& name) { return *gateway_.plant().find(name); }
  [[nodiscard]] process::SignalId running_of(const std::string& name) {
    return static_cast<process::SignalId>(drive(name).model().faults.running.value());
  }
  [[nodiscard]] const config::Model& in_use() { return gateway_.plant().model(); }

  config::Model file_;
  bool broken_ = false;
  bool throws_ = false;
  int begins_ = 0;
  int ends_ = 0;
  int loads_ = 0;
  Reload reload_{loop_.executor(),
                 gateway_,
                 {.load =
                      [this] {
                        ++loads_;
                        if (throws_) {
                          throw std::runtime_error("no memory");
                        }
                        return broken_ ? config::Loaded{.model = std::nullopt,
                                                        .findings = {{.file = "gateway.toml", .line = 3, .text = "no"}}}
                                       : config::Loaded{.model = file_, .findings = {}};
                      },
                  .begins = [this] { ++begins_; },
                  .ends = [this] { ++ends_; }}};
};

}  // namespace gateway
