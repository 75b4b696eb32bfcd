// Runs and stops in random order: after a confirmed stop no older run.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/process/stop_first_bench.h"

namespace process {
namespace {

using namespace std::chrono_literals;

struct RandomOrderCase {
  const char* name;
  bool slow;        ///< Answers of the drive.
  bool supervised;  ///< Its RPDO: it is repeated.
};

/// Runs of two writers, set-points and stops of a third in random order, each run with a word of its own.
class RandomOrderTest : public StopFirstTest, public testing::WithParamInterface<RandomOrderCase> {
 protected:
  struct Given {
    Sent sent;
    Raw word = 0;  ///< Of a run; of a stop the newest run before it; 0: set-points only.
    bool stop = false;
    bool told = false;
  };

  RandomOrderTest() {
    model_.commands.deadline = 400ms;
    if (GetParam().supervised) {
      model_.node.rpdos[0].event_timer = std::uint16_t{20};
    }
  }

  void tick() {
    run(1ms);
    hear();
    look();
  }
  /// The drive: RPDOs act at once; an SDO write when it is answered.
  void hear() {
    const auto& heard = slave_.heard();
    for (; heard_ < heard.size(); ++heard_) {
      const canopen::Frame& frame = heard[heard_];
      if (frame.id == kRpdo1) {
        ++by_rpdo_;
        expect_no_older_run(word_at(frame, 0));
        note(word_at(frame, 0), canopen::Clock::now());
      } else if (is_control_write(frame)) {
        note(word_at(frame, 4), canopen::Clock::now() + delay_ - 1ms);
        ++by_sdo_;
      }
    }
    while (!effects_.empty() && effects_.begin()->first <= canopen::Clock::now()) {
      holds_ = effects_.begin()->second;
      effects_.erase(effects_.begin());
      check("takes effect in the drive");
    }
  }
  static Raw word_at(const canopen::Frame& frame, std::size_t byte) {
    return static_cast<Raw>(frame.data[byte] | frame.data[byte + 1] << 8);
  }
  static bool is_control_write(const canopen::Frame& frame) {
    return frame.id == 0x605 && frame.data[0] == 0x2B && frame.data[1] == 0x30 && frame.data[3] == 2;
  }
  void note(Raw word, canopen::TimePoint at) {
    on_bus_.push_back(word);
    if (word != kStop) {
      EXPECT_FALSE(stopped_ && word <= *stopped_)
          << "run " << word << " is on the bus after a newer stop was confirmed";
    }
    effects_.emplace(at, word);
  }
  /// What was handed over before the stop came may leave yet.
  void expect_no_older_run(Raw word) const {
    const bool came = stop_came_ && canopen::Clock::now() > *stop_came_ + kHandedOver;
    EXPECT_FALSE(came && word != kStop && word <= before_stop_) << "run " << word << " by RPDO after a newer stop came";
  }
  void check(const char* what) const {
    EXPECT_FALSE(stopped_ && holds_ != kStop && holds_ <= *stopped_)
        << "run " << holds_ << " " << what << " after a newer stop was confirmed";
  }
  void look() {
    for (Given& each : given_) {
      if (each.told || !each.sent.done()) {
        continue;
      }
      each.told = true;
      const Outcome outcome = each.sent.get();
      ++outcomes_[(each.stop ? "stop " : "run ") +
                  (outcome.has_value() ? "ok" : std::string(name_of(outcome.error().kind)))];
      if (each.stop && outcome.has_value()) {
        stopped_ = std::max(stopped_.value_or(0), each.word);
        check("is held");
      }
    }
  }
  void give(std::mt19937& random) {
    const auto kind = random() % 10;
    const Writer::Way way = random() % 2 == 0 ? Writer::Way::modbus : Writer::Way::mqtt;
    std::vector<FieldWrite> fields;
    if (kind == 9) {
      given_.push_back({write_by(origin(way), {field("frequency_command", 7.0)})});
      return;
    }
    const bool stop = kind < 3;
    const Raw word = stop ? kStop : next_word_;
    if (stop) {
      before_stop_ = next_word_ - 1;
      stop_came_ = canopen::Clock::now();
    }
    fields.push_back(field("control_command", word));
    if (kind == 2 || kind == 8) {
      fields.push_back(field("frequency_command", 10.0));
      fields.push_back(field("torque_command", 0.0));
    }
    given_.push_back({write_by(origin(stop ? Writer::Way::local : way), std::move(fields)),
                      stop ? next_word_ - 1 : next_word_++, stop});
  }
  [[nodiscard]] bool all_told() const {
    return std::all_of(given_.begin(), given_.end(), [](const Given& each) { return each.told; });
  }
  void expect_nothing_superseded_on_the_bus() const {
    for (const Given& each : given_) {
      const Outcome outcome = each.sent.get();
      if (!each.stop && each.word != 0 && outcome.has_error() && outcome.error().kind == ErrorKind::superseded) {
        EXPECT_EQ(std::count(on_bus_.begin(), on_bus_.end(), each.word), 0) << "run " << each.word;
      }
    }
  }
  /// The set-points are forgotten now and then, so that words go by SDO as well as by RPDO.
  void begin_anew(std::mt19937& random) {
    given_.clear();
    effects_.clear();
    on_bus_.clear();
    if (random() % 2 == 0) {
      // By another master: a drive that goes there and back by itself so fast is two drives.
      slave_.send(0x000, {128, 5});
      slave_.set_state(127);
      slave_.send(0x705, {127});
      run(5ms);
      slave_.set_state(5);
      slave_.send(0x705, {5});
      run(5ms);
      show(test::kRunningBit);
    }
    slave_.forget_heard();
    heard_ = 0;
    stopped_.reset();
    stop_came_.reset();
    holds_ = 0;
  }

  static constexpr Duration kHandedOver = 2ms;

  Duration delay_{};
  std::size_t heard_ = 0;
  std::multimap<canopen::TimePoint, Raw> effects_;
  std::vector<Raw> on_bus_;
  std::vector<Given> given_;
  std::optional<Raw> stopped_;                   ///< Runs up to this word are older than a confirmed stop.
  std::optional<canopen::TimePoint> stop_came_;  ///< The newest one,
  Raw before_stop_ = 0;                          ///< and the newest run before it.
  Raw next_word_ = 100;
  Raw holds_ = 0;
  int by_sdo_ = 0;
  int by_rpdo_ = 0;
  std::map<std::string, int> outcomes_;
};

TEST_P(RandomOrderTest, AfterAConfirmedStopNoOlderRunIsOnTheBusOrTakesEffect) {
  bring_online();
  show(test::kRunningBit);
  const bool slow = GetParam().slow;
  for (unsigned seed = 1; seed <= 1000 && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    begin_anew(random);
    ASSERT_EQ(drive_->status().nmt, canopen::NmtState::operational);
    delay_ = std::chrono::milliseconds(slow ? 60 : 3 + random() % 10);
    slave_.delay_answers(delay_);
    for (auto commands = 3 + random() % 8; commands > 0; --commands) {
      give(random);
      for (auto pause = random() % (slow ? 50 : 12); pause > 0; --pause) {
        tick();
      }
    }
    for (int ms = 0; ms < 900 && !all_told(); ++ms) {
      tick();
    }
    for (int ms = 0; ms < 2 * delay_ / 1ms; ++ms) {
      tick();
    }
    ASSERT_TRUE(all_told());
    expect_nothing_superseded_on_the_bus();
  }
  EXPECT_GE(by_sdo_, 500) << "a test of nothing";
  EXPECT_GE(by_rpdo_, GetParam().supervised ? 5000 : 500) << "a test of nothing";
  EXPECT_GE(outcomes_["run superseded"], 100) << testing::PrintToString(outcomes_);
  EXPECT_GE(outcomes_["run ok"], 500) << testing::PrintToString(outcomes_);
  EXPECT_GE(outcomes_["stop ok"], 500) << testing::PrintToString(outcomes_);
}

INSTANTIATE_TEST_SUITE_P(SdoTask, RandomOrderTest,
                         testing::Values(RandomOrderCase{"Prompt", false, false}, RandomOrderCase{"Slow", true, false},
                                         RandomOrderCase{"PromptSupervised", false, true},
                                         RandomOrderCase{"SlowSupervised", true, true}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace process
