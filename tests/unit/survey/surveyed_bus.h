#pragma once

#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/survey/bus_survey.h"
#include "tests/support/bus_fixture.h"
#include "tests/support/frame.h"

namespace canopen::test {

inline constexpr std::uint8_t kNode = 5;
inline constexpr std::uint8_t kOperational = 5;
inline constexpr Duration kTpdoPeriod = std::chrono::milliseconds(20);

/// A bus by hand, and its survey with what that told.
class SurveyedBus : public testing::Test {
 protected:
  SurveyedBus()
      : bus_(loop_.executor(), std::make_unique<support::HandLink>(events_), support::kQuiet),
        survey_(loop_.executor(), bus_,
                {.known = [this] { return known_; },
                 .began = [this](const Suspicion& began,
                                 const auto& /*displaced*/) { told_.push_back("began: " + began.text()); },
                 .ended = [this](const Suspicion& ended) { told_.push_back("ended: " + ended.text()); }}) {
    known_.served.set(kNode);
    survey_.set_timeout(kNode, std::chrono::seconds(2));
    bus_.start();
    survey_.start();
    be({.condition = BusCondition::error_active});
  }
  ~SurveyedBus() override { survey_.stop(); }

  void be(const BusState& state) { events_->on_bus_state(state); }
  static Received now(const Frame& frame) { return {frame, Clock::now(), wall_now()}; }
  void hear(const Frame& heard) {
    const Received received = now(heard);
    events_->on_frames({&received, 1});
  }
  void error(unsigned kind, std::uint32_t classes = CAN_ERR_PROT | CAN_ERR_BUSERROR) {
    Frame frame{.id = classes, .size = 8, .error = true};
    frame.data[2] = static_cast<std::uint8_t>(kind);
    events_->on_error_frame(now(frame), ErrorSign::other);
  }
  /// A TPDO each 20 ms, a heartbeat each 500 ms.
  void traffic(Duration time) {
    for (int i = 0; i < time / kTpdoPeriod; ++i) {
      if (i % 25 == 0) {
        hear(support::frame(0x705, kOperational));
      }
      hear(support::frame(0x185));
      loop_.advance(kTpdoPeriod, kTpdoPeriod);
    }
  }
  [[nodiscard]] std::string kind() const {
    const BusHealth health = survey_.health();
    return health.suspicion ? std::string(name_of(health.suspicion->kind)) : "none";
  }

  support::HandDrivenLoop loop_;
  LinkEvents* events_ = nullptr;
  BusSurvey::Known known_;
  std::vector<std::string> told_;
  Bus bus_;
  BusSurvey survey_;
};

}  // namespace canopen::test
