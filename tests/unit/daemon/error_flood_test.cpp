// A bus whose driver tells of thousands of errors a second, and a controller that goes to and fro: what the gateway's
// log says of it, and that its drives are served.
#include <gmock/gmock.h>
#include <linux/can/error.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "canopen/bus/virtual_link.h"
#include "daemon/gateway.h"
#include "daemon/simulated_site.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/demo_model.h"

namespace gateway {
namespace {

using namespace std::chrono_literals;
using canopen::BusCondition;
using canopen::ErrorSign;

/// A link whose driver a test may speak for.
class DisturbedLink final : public canopen::Link {
 public:
  DisturbedLink(std::unique_ptr<canopen::Link> link, canopen::LinkEvents*& events)
      : link_(std::move(link)), events_(events) {}
  void open(canopen::LinkEvents& events) override {
    events_ = &events;
    link_->open(events);
  }
  void close() override {
    events_ = nullptr;
    link_->close();
  }
  canopen::SendResult send(const canopen::Frame& frame) override { return link_->send(frame); }

 private:
  std::unique_ptr<canopen::Link> link_;
  canopen::LinkEvents*& events_;
};

class ErrorFloodTest : public testing::Test {
 protected:
  ErrorFloodTest() {
    model_.modbus.reset();
    model_.mqtt.reset();
    model_.http.reset();
    model_.gateway.control.clear();
    auto logger = std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::ostream_sink_st>(log_));
    logger->set_pattern("%v");
    spdlog::set_default_logger(std::move(logger));
    drives_.add_drives(drives_.add_network(wire_.connect()), model_, 0);
    gateway_ = std::make_unique<Gateway>(loop_.executor(), model_, [this](const config::Bus&) {
      return std::make_unique<DisturbedLink>(wire_.connect(), events_);
    });
    gateway_->start();
    drives_.start();
    loop_.advance(5s);
    EXPECT_EQ(gateway_->plant().online(), model_.drives.size());
    log_.str("");
  }
  ~ErrorFloodTest() override {
    const auto stopped = support::spawn(loop_.executor(), gateway_->stop());
    EXPECT_TRUE(loop_.advance_until([&] { return *stopped; }, 5s));
    drives_.stop();
    loop_.settle();
    spdlog::set_default_logger(before_);
  }

  /// Five of them each millisecond; after each fiftieth the controller is in the other of the two states.
  void flood(canopen::Duration time, std::pair<BusCondition, BusCondition> states) {
    for (canopen::Duration passed{}; passed < time; passed += 1ms) {
      for (int i = 0; i < 5; ++i) {
        canopen::Frame frame{.id = CAN_ERR_PROT | CAN_ERR_BUSERROR, .size = 8, .error = true};
        frame.data[2] = i % 2 == 0 ? CAN_ERR_PROT_STUFF : CAN_ERR_PROT_FORM;
        events_->on_error_frame({frame, canopen::Clock::now(), canopen::wall_now()}, ErrorSign::other);
        if (++errors_ % 50 == 0) {
          events_->on_bus_state({errors_ % 100 == 0 ? states.first : states.second, 0, 100});
        }
      }
      loop_.advance(1ms);
    }
  }
  /// Since the flood began, those with these words.
  [[nodiscard]] std::vector<std::string> lines_with(const std::string& words) const {
    std::vector<std::string> found;
    std::istringstream all(log_.str());
    for (std::string line; std::getline(all, line);) {
      if (line.find(words) != line.npos) {
        found.push_back(line);
      }
    }
    return found;
  }

  support::HandDrivenLoop loop_;
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  std::ostringstream log_;
  config::Model model_ = test::demo_model();
  canopen::VirtualBus wire_{loop_.executor()};
  SimulatedSite drives_{loop_.executor()};
  canopen::LinkEvents* events_ = nullptr;
  std::uint64_t errors_ = 0;
  std::unique_ptr<Gateway> gateway_;
};

TEST_F(ErrorFloodTest, ErrorsAloneAreOneSuspicion) {
  flood(5s, {BusCondition::error_active, BusCondition::error_active});
  EXPECT_THAT(lines_with(""), testing::ElementsAre(testing::HasSubstr("suspicion: wiring or termination may be bad")));
  EXPECT_EQ(gateway_->plant().online(), model_.drives.size());
  EXPECT_FALSE(gateway_->plant().bus_alarm(0).active);
  EXPECT_GT(gateway_->plant().bus_statistics(0).error_frames, 9000U) << "of the last 10 000 frames";
}

TEST_F(ErrorFloodTest, AControllerThatGoesToAndFroHasTwoLinesASecond) {
  flood(5s, {BusCondition::error_active, BusCondition::passive});
  EXPECT_EQ(lines_with("suspicion").size(), 1U);
  const auto of_bus = lines_with("bus demo: ");
  EXPECT_GE(of_bus.size(), 2U);
  EXPECT_LE(of_bus.size(), 11U) << "two a second, and the first at once";
  EXPECT_EQ(lines_with("").size(), of_bus.size() + 1) << "and nothing else";
  EXPECT_EQ(gateway_->plant().online(), model_.drives.size());
  loop_.advance(2s);
  EXPECT_FALSE(gateway_->plant().bus_alarm(0).active) << "it was error-active in the end";
}

}  // namespace
}  // namespace gateway
