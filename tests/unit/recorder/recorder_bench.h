#pragma once

#include <gtest/gtest.h>

#include <boost/json/parse.hpp>
#include <chrono>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "bridges/recorder/recorder.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "tests/unit/journal/loop.h"
#include "tests/unit/process/test_drive.h"
#include "tests/unit/recorder/record_bench.h"

namespace recorder {

using namespace std::chrono_literals;

/// Two buses, a drive on each that is not there, and a recorder whose frames a test makes by hand.
class RecorderBench : public ::testing::Test {
 protected:
  RecorderBench() {
    model_.gateway.name = "line3";
    model_.recorder.emplace();
    for (const char* name : {"can0", "can1"}) {
      model_.buses.push_back({.name = name, .interface = name, .bitrate = 125'000});
      config::Drive drive = process::test::drive();
      drive.bus = model_.buses.size() - 1;
      drive.name = "pump" + std::to_string(model_.buses.size());
      model_.drives.push_back(std::move(drive));
    }
  }
  ~RecorderBench() override { end(); }

  void make() {
    std::vector<process::Plant::BusPort> ports;
    for (std::size_t i = 0; i < 2; ++i) {
      buses_.push_back(
          std::make_unique<canopen::Bus>(loop_.executor(), wires_[i].connect(), canopen::BusSettings{.node_id = 0}));
      ports.push_back({buses_[i].get(), {}});
    }
    plant_ = std::make_unique<process::Plant>(loop_.executor(), model_, std::move(ports));
    recorder_ = std::make_unique<Recorder>(
        loop_.executor(), *plant_,
        KeptAt{.state_directory = bench_.state(), .keep = model_.recorder->keep, .calls = bench_.calls()},
        [this](std::size_t, canopen::TimePoint until) { return canopen::Clock::now() < until + lag_; },
        Recorder::Notices{.warning = [this](const std::string& text) { warnings_.push_back(text); },
                          .info = [this](const std::string& text) { infos_.push_back(text); }});
    plant_->add(*recorder_);
  }
  void start() {
    if (!recorder_) {
      make();
    }
    recorder_->start();
    ASSERT_TRUE(loop_.run_until([&] { return recorder_->keeper().records().has_value(); }));
    set_bus(canopen::BusCondition::error_active);
  }
  void end() {
    if (recorder_) {
      const auto ended = loop_.start(recorder_->stop());
      EXPECT_TRUE(loop_.run_until([&] { return *ended; }));
      recorder_.reset();
    }
  }

  void set_bus(canopen::BusCondition condition, std::size_t bus = 0) { plant_->set_bus_state(bus, {condition, 0, 0}); }
  void trip(std::size_t bus = 0) {
    set_bus(canopen::BusCondition::error_active, bus);
    set_bus(canopen::BusCondition::bus_off, bus);
  }
  /// A frame each 100 ms, numbered.
  void run(canopen::Duration time) {
    for (canopen::Duration passed{}; passed < time; passed += 100ms) {
      recorder_->ring(0).on_frame(
          {support::frame(0x185, static_cast<std::uint8_t>(++frames_)), canopen::Clock::now(), canopen::wall_now()},
          canopen::FrameOrigin::others);
      loop_.hand().advance(100ms, 100ms);
    }
  }
  void pass(canopen::Duration time) { loop_.hand().advance(time, 100ms); }
  void await_kept(std::size_t count) {
    ASSERT_TRUE(loop_.run_until([&] { return records().size() == count; })) << records().size();
  }
  [[nodiscard]] const std::vector<StoredRecord>& records() const { return recorder_->keeper().records()->all(); }
  [[nodiscard]] std::vector<std::string> lines_of(const std::string& stem) const {
    std::istringstream text(bench_.text_of(stem + ".log"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) {
      lines.push_back(line);
    }
    return lines;
  }
  [[nodiscard]] boost::json::value json_of(const std::string& stem) const {
    return boost::json::parse(bench_.text_of(stem + ".json"));
  }

  config::Model model_;
  RecordBench bench_;
  journal::LoopWithThread loop_;
  std::array<canopen::VirtualBus, 2> wires_{canopen::VirtualBus(loop_.executor()),
                                            canopen::VirtualBus(loop_.executor())};
  std::vector<std::unique_ptr<canopen::Bus>> buses_;
  std::unique_ptr<process::Plant> plant_;
  std::unique_ptr<Recorder> recorder_;
  std::vector<std::string> warnings_;
  std::vector<std::string> infos_;
  canopen::Duration lag_{};  ///< Of the loop.
  int frames_ = 0;
};

}  // namespace recorder
