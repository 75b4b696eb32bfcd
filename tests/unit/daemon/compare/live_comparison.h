#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "daemon/compare/compare.h"
#include "daemon/control/plant_service.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/demo_model.h"
#include "tests/unit/daemon/demo_plant.h"

namespace gateway::compare {

inline constexpr std::size_t kFan = 0;    // veichi-ac300, node 3
inline constexpr std::size_t kPump = 1;   // veichi-ac310, node 5
inline constexpr std::size_t kHoist = 2;  // invt-goodrive600, node 7
inline constexpr std::size_t kMixer = 3;  // vacon-opte6, node 9

inline config::Model quiet_demo() {
  config::Model model = test::demo_model();
  model.modbus.reset();
  model.mqtt.reset();
  model.http.reset();
  model.gateway.control.clear();
  return model;
}

class LiveComparison : public test::DemoPlant {
 protected:
  LiveComparison() : DemoPlant(quiet_demo()), configured_(model_), notes_(test::demo_loaded().notes) { begin_plant(); }
  ~LiveComparison() override { end_plant(); }

  std::optional<std::string> ask(const std::string& request) {
    ++asked_;
    control::Line line = control::parse_line(request);
    EXPECT_TRUE(line.request.has_value()) << request;
    const auto answer = support::spawn(loop_.executor(), service_.answer({.request = std::move(line.request.value()),
                                                                          .id = line.id,
                                                                          .user = "anna",
                                                                          .received = canopen::Clock::now()}));
    EXPECT_TRUE(loop_.advance_until([&] { return answer.done(); }, std::chrono::seconds(20))) << request;
    return answer.done() ? std::optional(answer.get()) : std::nullopt;
  }
  Comparison look() {
    const auto running = read_running(ask(R"({"op":"status"})").value());
    return compare(configured_, notes_, running.value(), [this](const std::string& request) { return ask(request); });
  }
  std::vector<std::string> findings() {
    std::vector<std::string> lines;
    for (const config::Finding& finding : look().findings) {
      lines.push_back(to_string(finding));
    }
    return lines;
  }
  // Sets an object of a simulated drive as somebody at its keypad would.
  void set(std::size_t drive, simulator::Address address, std::uint32_t value) {
    simulator::Object* const object = drives_[drive]->dictionary().find(address);
    ASSERT_NE(object, nullptr);
    ASSERT_EQ(simulator::ObjectDictionary::write(*object, value), simulator::Abort::none);
  }
  [[nodiscard]] canopen::BootResult letter_of(std::size_t drive) {
    return gateway_.plant().drive(drive).status().boot_result;
  }
  // Powers it off and on, until its boot has ended with a letter.
  void boot_again(std::size_t drive) {
    drives_[drive]->power_off();
    loop_.advance(std::chrono::seconds(5), std::chrono::milliseconds(5));
    drives_[drive]->power_on();
    ASSERT_TRUE(loop_.advance_until([&] { return is_letter(letter_of(drive)); }, std::chrono::seconds(30)));
    ASSERT_FALSE(gateway_.plant().drive(drive).status().online);
  }
  canopen::NodeSettings& node(std::size_t drive) { return configured_.drives[drive].node; }

  config::Model configured_;  ///< What `check` reads; the gateway runs model_.
  std::vector<config::DriveNotes> notes_;
  control::Service service_ = control::plant_service(gateway_.plant());
  std::size_t asked_ = 0;
};

/// Of the drive, or of the configuration beside it.
using LiveDifference = LiveComparison;

}  // namespace gateway::compare
