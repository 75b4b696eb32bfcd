#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "tests/unit/canopen/sdo_bench.h"

namespace canopen {

constexpr ObjectAddress kSetPoint{0x2030, 4};
constexpr Raw kRun = 1;
constexpr Raw kHalt = 5;

/// Stops to a slave that may be slow.
class SdoStopBench : public SdoBench {
 protected:
  SdoStopBench() {
    for (const ObjectAddress object : {kStatus, kCommand, kSetPoint}) {
      slave_.set(object, DataType::u16, 0);
    }
  }

  support::Spawned<Result<void>> stop(Duration within = std::chrono::milliseconds(800),
                                      unsigned most_sent = SdoClient::kStopsSent) {
    return support::spawn(loop_.executor(),
                          client_->write_stop(kCommand, DataType::u16, kHalt, Clock::now() + within, most_sent));
  }
  /// The node does one thing at a time, and needs that long for each.
  void serve_slowly(Duration reads, Duration writes) {
    slave_.script([this, reads, writes](const Bytes& request) -> std::optional<Answers> {
      const TimePoint now = Clock::now();
      busy_until_ = std::max(busy_until_, now) + ((request[0] & 0xE0U) == 0x20 ? writes : reads);
      slave_.delay_answers(busy_until_ - now);
      return std::nullopt;
    });
  }
  void confirm(ObjectAddress object) { answer(0x60, object, 0); }
  void refuse(ObjectAddress object) { answer(0x80, object, 0x08); }
  void answer(std::uint8_t command, ObjectAddress object, std::uint8_t last) {
    slave_.send(0x585, {command, static_cast<std::uint8_t>(object.index & 0xFFU),
                        static_cast<std::uint8_t>(object.index >> 8U), object.sub, 0, 0, 0, last});
    loop_.advance(std::chrono::milliseconds(1));
  }
  [[nodiscard]] long stops_heard() const {
    const std::vector<Frame> heard = slave_.heard_on(0x605);
    return std::count(heard.begin(), heard.end(), make_frame(0x605, Bytes{0x2B, 0x30, 0x20, 2, kHalt, 0, 0, 0}));
  }
  void expect_on_the_wire_within(Duration limit) {
    EXPECT_TRUE(loop_.advance_until([this] { return stops_heard() > 0; }, limit));
  }
  static void expect_unknown(const support::Spawned<Result<void>>& ended, ErrorKind kind, const std::string& text) {
    ASSERT_TRUE(ended.done());
    ASSERT_TRUE(ended.get().has_error());
    EXPECT_EQ(ended.get().error().kind, kind);
    EXPECT_TRUE(ended.get().error().outcome_unknown);
    EXPECT_NE(ended.get().error().detail.find(text), std::string::npos) << ended.get().error().detail;
  }

 private:
  TimePoint busy_until_{};
};

}  // namespace canopen
