// A stop is never behind anything.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "tests/unit/process/commands_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;

constexpr canopen::Raw kStop = 5;
constexpr canopen::ObjectAddress kSlowObject{0x2100, 1};

class StopFirstTest : public CommandsTest {
 protected:
  using Sent = support::Spawned<Outcome>;

  Sent write_by(const Origin& from, std::vector<FieldWrite> fields) {
    return support::spawn(loop_.executor(), drive_->write(from, std::move(fields)));
  }
  Sent stop_by(Writer::Way way) { return write_by(origin(way), {field("control_command", kStop)}); }
  /// An SDO write of an object without a signal, as a parameter that goes to flash.
  Sent write_slow_object() {
    return support::spawn(loop_.executor(), drive_->sdo_write(origin(), {kSlowObject, DataType::u16, 1}));
  }
  /// Writes of it are answered that late, or not at all.
  void answer_slow_object(std::optional<Duration> after) {
    model_.commands.raw = true;
    slave_.set(kSlowObject, DataType::u16, 0);
    slave_.script([this, after](const Bytes& request) -> std::optional<std::vector<Bytes>> {
      if (request[1] != 0x00 || request[2] != 0x21) {
        return std::nullopt;
      }
      if (after) {
        slow_answer_at_ = canopen::Clock::now() + *after;
      }
      return std::vector<Bytes>{};
    });
  }
  /// Time passes until the control command is on the wire, by whichever way; at most `limit`.
  Duration until_on_wire(Duration limit) {
    Duration passed{};
    while (passed < limit && !control_on_wire()) {
      step();
      passed += 1ms;
    }
    return passed;
  }
  void step() {
    run(1ms);
    if (slow_answer_at_ && canopen::Clock::now() >= *slow_answer_at_) {
      slow_answer_at_.reset();
      slave_.send(0x585, {0x60, 0x00, 0x21, 0x01, 0, 0, 0, 0});
      loop_.settle();
    }
  }
  [[nodiscard]] bool control_on_wire() const {
    const auto writes = sdo_writes();
    return !rpdos().empty() || std::find(writes.begin(), writes.end(), test::kControl) != writes.end();
  }
  void expect_stopped_beside_slow_write(Duration confirmed_within) {
    bring_online();
    show(test::kRunningBit);
    const Sent slow = write_slow_object();
    run(10ms);
    const Sent stop = stop_by(Writer::Way::mqtt);
    EXPECT_LE(until_on_wire(400ms), 150ms);
    for (Duration passed{}; passed < confirmed_within && !stop.done(); passed += 1ms) {
      step();
    }
    ASSERT_TRUE(stop.done());
    EXPECT_TRUE(stop.get().has_value()) << canopen::to_string(stop.get().error());
    ASSERT_TRUE(slow.done());
    ASSERT_TRUE(slow.get().has_error());
    EXPECT_TRUE(slow.get().error().outcome_unknown);
    EXPECT_EQ(slave_.value(test::kControl), kStop);
  }

  std::optional<canopen::TimePoint> slow_answer_at_;
};

/// One signal set 15 times a second by a client, and a stop each second by another, for a minute.
class BusyDriveTest : public StopFirstTest {
 protected:
  struct Stop {
    Sent sent;
    canopen::TimePoint at;
    std::optional<canopen::TimePoint> on_wire{};
    std::optional<canopen::TimePoint> answered{};
  };

  void begin_what_is_due(int ms) {
    if (ms % 66 == 0) {
      asked_ = 1000 + canopen::Raw(ms / 66);
      set_points_.push_back(write_by(origin(), {field("frequency_command", asked_)}));
    }
    if (ms % 1000 == 500) {
      slave_.forget_heard();
      stops_.push_back({stop_by(Writer::Way::mqtt), canopen::Clock::now()});
    }
  }
  void look() {
    if (stops_.empty()) {
      return;
    }
    Stop& newest = stops_.back();
    if (!newest.on_wire && control_on_wire()) {
      newest.on_wire = canopen::Clock::now();
    }
    if (!newest.answered && newest.sent.done()) {
      newest.answered = canopen::Clock::now();
    }
  }

  std::vector<Sent> set_points_;
  std::vector<Stop> stops_;
  canopen::Raw asked_ = 0;
};

TEST_F(BusyDriveTest, EachStopIsOnTheWireAndConfirmedInTimeAndNoSetPointIsUnknown) {
  bring_online();
  slave_.delay_answers(100ms);
  for (int ms = 0; ms < 60'000; ++ms) {
    begin_what_is_due(ms);
    run(1ms);
    look();
  }
  run(1s);
  look();
  ASSERT_EQ(stops_.size(), 60U);
  for (const Stop& stop : stops_) {
    ASSERT_TRUE(stop.on_wire && stop.answered);
    EXPECT_LE(*stop.on_wire - stop.at, 150ms);
    EXPECT_LE(*stop.answered - stop.at, 300ms);
    EXPECT_TRUE(stop.sent.get().has_value());
  }
  std::map<std::string, int> outcomes;
  for (const Sent& sent : set_points_) {
    ASSERT_TRUE(sent.done());
    const Outcome outcome = sent.get();
    ++outcomes[outcome.has_value() ? "ok" : std::string(name_of(outcome.error().kind))];
  }
  EXPECT_GE(outcomes["ok"], 300);
  EXPECT_EQ(outcomes["ok"] + outcomes["superseded"], static_cast<int>(set_points_.size()))
      << testing::PrintToString(outcomes);
  EXPECT_EQ(slave_.value(test::kFrequency), asked_);
}

TEST_F(StopFirstTest, BesideAWriteThatTakes700Milliseconds) {
  answer_slow_object(700ms);
  expect_stopped_beside_slow_write(800ms);
}

TEST_F(StopFirstTest, BesideAWriteThatIsNeverAnswered) {
  answer_slow_object(std::nullopt);
  expect_stopped_beside_slow_write(300ms);
}

TEST_F(StopFirstTest, SixtyFourWaitingCommandsDelayNoStop) {
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(50ms);
  std::vector<Sent> waiting;
  for (int i = 0; i < 64; ++i) {
    waiting.push_back(write_by(origin(), {field("control_command", Raw{100} + Raw(i))}));
  }
  run(20ms);
  slave_.forget_heard();
  const Sent stop = stop_by(Writer::Way::mqtt);
  EXPECT_LE(until_on_wire(400ms), 60ms);
  EXPECT_TRUE(finish(stop, 200ms).has_value());
  run(1s);
  EXPECT_EQ(slave_.value(test::kControl), kStop);
  ASSERT_TRUE(waiting.front().get().has_value()) << "it had left";
  for (std::size_t i = 1; i < waiting.size(); ++i) {
    expect_refused(waiting[i].get(), ErrorKind::superseded);
  }
}

TEST_F(StopFirstTest, GoesWhereASetPointBesideItIsOutOfRangeAndTheLeaseIsForeign) {
  model_.commands.lease = 10s;
  model_.signals[signal("frequency_command")].min = 10.0;
  bring_online();
  run_motor();
  const Outcome outcome =
      finish(write_by(origin(Writer::Way::mqtt), {field("control_command", kStop), field("frequency_command", Raw{0}),
                                                  field("torque_command", Raw{0})}));
  expect_refused(outcome, ErrorKind::lease);
  EXPECT_EQ(outcome.written, 1U);
  EXPECT_NE(outcome.error().detail.find("already written: control_command"), std::string::npos);
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xB8, 0x0B, 0, 0}}));
  expect_refused(write_now({field("control_command", Raw{1})}), ErrorKind::lease);
  EXPECT_TRUE(write_now({field("control_command", kStop)}).has_value()) << "he has seen it now";
  EXPECT_TRUE(write_now({field("control_command", Raw{1})}).has_value());
}

TEST_F(StopFirstTest, ASetPointOutOfRangeIsAnsweredAsSuchAndTheStopIsSent) {
  model_.signals[signal("frequency_command")].min = 10.0;
  bring_online();
  run_motor();
  const Outcome outcome = write_now({field("control_command", kStop), field("frequency_command", Raw{0})});
  expect_refused(outcome, ErrorKind::range);
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xB8, 0x0B, 0, 0}}));
}

TEST_F(StopFirstTest, IsWrittenToADriveThatIsLeftAlone) {
  slave_.set_state(5);
  model_.node.setup = {{test::kLimit, DataType::u16, 77}};
  start();
  run(3s);
  ASSERT_EQ(drive_->status().boot_result, canopen::BootResult::left_alone);
  slave_.forget_heard();
  EXPECT_TRUE(write_now({field("control_command", kStop), field("frequency_command", 10.0)}).has_error())
      << "its set-points are not sent";
  EXPECT_EQ(sdo_writes(), Objects{test::kControl});
  EXPECT_TRUE(rpdos().empty());
  EXPECT_EQ(slave_.value(test::kControl), kStop);
  expect_refused(write_now({field("control_command", Raw{1})}), ErrorKind::offline);
}

TEST_F(StopFirstTest, IsWrittenToADriveThatBoots) {
  start();
  slave_.delay_answers(30ms);
  slave_.boot_up();
  run(20ms);
  ASSERT_FALSE(drive_->status().configured);
  const Sent stop = stop_by(Writer::Way::modbus);
  EXPECT_LE(until_on_wire(400ms), 150ms);
  EXPECT_TRUE(finish(stop, 200ms).has_value());
  run(6s);
  EXPECT_TRUE(drive_->status().online) << "its boot goes on";
}

TEST_F(StopFirstTest, IsSentOnceToALostDriveAndAnsweredOffline) {
  bring_online();
  slave_.heartbeat_off(true);
  slave_.mute_sdo(true);
  silent_ = true;
  run(3s);
  ASSERT_FALSE(drive_->status().online);
  slave_.forget_heard();
  const Outcome outcome = finish(stop_by(Writer::Way::modbus), 900ms);
  expect_refused(outcome, ErrorKind::offline);
  EXPECT_TRUE(outcome.error().outcome_unknown);
  EXPECT_EQ(sdo_writes(), Objects{test::kControl});
}

TEST_F(StopFirstTest, ADriveThatTakesItByPdoOnlyIsStoppedWithWhatItHolds) {
  bring_online();
  for (const canopen::ObjectAddress object : {test::kControl, test::kFrequency, test::kTorque}) {
    slave_.refuse_write(object, 0x06010002);
  }
  slave_.set(test::kFrequency, DataType::u16, 4000);
  show(test::kRunningBit);
  EXPECT_TRUE(finish(stop_by(Writer::Way::modbus), 100ms).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xA0, 0x0F, 0, 0}}));
  slave_.forget_heard();
  expect_refused(write_now({field("control_command", Raw{1})}), ErrorKind::incomplete);
  EXPECT_TRUE(rpdos().empty()) << "set-points that nobody commanded complete a stop, and a stop alone";
}

TEST_F(StopFirstTest, TwoStopsAreTwoStops) {
  bring_online();
  show(test::kRunningBit);
  const Sent first = stop_by(Writer::Way::modbus);
  const Sent second = stop_by(Writer::Way::modbus);
  EXPECT_TRUE(finish(first).has_value());
  EXPECT_TRUE(finish(second).has_value());
  EXPECT_EQ(sdo_writes(), (Objects{test::kControl, test::kControl}));
}

TEST_F(StopFirstTest, AnEqualStopThatWaitsIsDoneByTheNewerOne) {
  bring_online();
  slave_.delay_answers(50ms);
  show(test::kRunningBit);
  const Sent first = stop_by(Writer::Way::modbus);
  run(1ms);
  const Sent second = stop_by(Writer::Way::modbus);
  const Sent third = stop_by(Writer::Way::mqtt);
  EXPECT_TRUE(finish(first, 200ms).has_value());
  EXPECT_TRUE(finish(third, 200ms).has_value());
  expect_refused(second.get(), ErrorKind::superseded);
}

TEST_F(StopFirstTest, NothingThatIsRepeatedHoldsARunWordOnceAStopCame) {
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  run_motor();
  run(150ms);
  ASSERT_FALSE(rpdos().empty());
  ASSERT_EQ(rpdos().back()[0], 1) << "the run command is repeated";
  slave_.forget_heard();
  const Sent stop = stop_by(Writer::Way::mqtt);
  run(1s);
  ASSERT_TRUE(stop.done());
  ASSERT_GE(rpdos().size(), 9U);
  for (const Bytes& rpdo : rpdos()) {
    EXPECT_EQ(rpdo[0], kStop);
  }
}

TEST_F(StopFirstTest, DoesNotWaitForTheSetPointsOfAnOlderStop) {
  bring_online();
  show(test::kRunningBit);
  slave_.mute(test::kFrequency);
  const Sent older = write_by(origin(), {field("control_command", kStop), field("frequency_command", 10.0)});
  run(30ms);
  slave_.forget_heard();
  const Sent stop = stop_by(Writer::Way::mqtt);
  EXPECT_LE(until_on_wire(400ms), 150ms);
  EXPECT_TRUE(finish(stop, 100ms).has_value());
  EXPECT_TRUE(finish(older, 900ms).has_error());
}

TEST_F(StopFirstTest, LeavesByRpdoWhileAnOlderStopWaitsForItsAnswer) {
  bring_online();
  show(test::kRunningBit);
  slave_.mute(test::kControl);
  const Sent older = stop_by(Writer::Way::modbus);
  run(30ms);
  slave_.forget_heard();
  const Sent stop =
      write_by(origin(Writer::Way::mqtt),
               {field("control_command", kStop), field("frequency_command", 10.0), field("torque_command", 0.0)});
  run(5ms);
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xE8, 0x03, 0, 0}}));
  finish(older, 900ms);
  finish(stop, 900ms);
}

TEST_F(StopFirstTest, ADriveThatTakesItByPdoOnlyAndDoesNotTellItsSetPointIsAnsweredInTime) {
  bring_online();
  slave_.refuse_write(test::kControl, 0x06010002);
  slave_.mute(test::kFrequency);
  show(test::kRunningBit);
  expect_refused(finish(stop_by(Writer::Way::modbus), 801ms), ErrorKind::incomplete);
}

TEST_F(StopFirstTest, ARefusalByTheStateOfTheDriveIsTriedByRpdo) {
  bring_online();
  slave_.refuse_write(test::kControl, 0x08000022);
  show(test::kRunningBit);
  EXPECT_TRUE(finish(stop_by(Writer::Way::modbus), 100ms).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0, 0, 0, 0}}));
}

TEST_F(StopFirstTest, TellsWhereTheDriveHeldItAlready) {
  bring_online();
  EXPECT_FALSE(write_now({field("control_command", kStop)}).unchanged);
  EXPECT_TRUE(write_now({field("control_command", kStop)}).unchanged);
}

TEST_F(StopFirstTest, ItsSetPointsAreNotSentOnceTheGatewayEnds) {
  bring_online();
  slave_.delay_answers(20ms);
  const Sent stop = write_by(origin(), {field("control_command", kStop), field("frequency_command", 10.0)});
  run(5ms);
  drive_->close();
  EXPECT_TRUE(finish(stop, 100ms).has_error());
  EXPECT_EQ(sdo_writes(), Objects{test::kControl});
}

TEST_F(StopFirstTest, IsSentByRpdoAgainWhereTheDriveRefusesItBehindAnOlderRun) {
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(5s);
  const Sent run_command = write({field("control_command", Raw{1})});
  run(5ms);
  slave_.delay_answers(0ms);
  slave_.refuse_write(test::kControl, 0x08000022);
  const Sent stop =
      write_by(origin(Writer::Way::mqtt),
               {field("control_command", kStop), field("frequency_command", 10.0), field("torque_command", 0.0)});
  EXPECT_TRUE(finish(stop, 300ms).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xE8, 0x03, 0, 0}, {5, 0, 0xE8, 0x03, 0, 0}}))
      << "the drive may have carried out the run between the first one and its refusal";
  finish(run_command, 900ms);
}

TEST_F(StopFirstTest, TheNewestOfTwoIsTheLastOnTheBus) {
  constexpr Raw kOtherStop = 6;
  model_.node.motor.stops.push_back({.equals = kOtherStop});
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(60ms);
  const auto reading = support::spawn(loop_.executor(), drive_->sdo_read(test::kOutput, DataType::u16));
  run(2ms);
  const Sent older = stop_by(Writer::Way::modbus);
  run(2ms);
  const Sent newer =
      write_by(origin(Writer::Way::mqtt),
               {field("control_command", kOtherStop), field("frequency_command", 10.0), field("torque_command", 0.0)});
  run(3ms);
  EXPECT_EQ(rpdos().size(), 1U) << "it does not wait";
  EXPECT_TRUE(finish(newer, 500ms).has_value());
  finish(older, 500ms);
  EXPECT_EQ(slave_.value(test::kControl), kOtherStop);
  ASSERT_FALSE(sdo_writes().empty());
  EXPECT_EQ(sdo_writes().back(), test::kControl);
  EXPECT_TRUE(reading.done());
}

TEST_F(StopFirstTest, SetPointsOfTwoStopsKeepTheirOrder) {
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(20ms);
  const Sent slow = write({field("upper_limit", Raw{4000})});
  run(2ms);
  const Sent first = write({field("control_command", kStop), field("frequency_command", 10.0)});
  const Sent second = write({field("control_command", kStop), field("frequency_command", 20.0)});
  EXPECT_TRUE(finish(first, 500ms).has_value());
  EXPECT_TRUE(finish(second, 500ms).has_value());
  EXPECT_EQ(slave_.value(test::kFrequency), 2000U);
  EXPECT_TRUE(slow.done());
}

TEST_F(StopFirstTest, NeedsPermission) {
  model_.commands.writers.mqtt = false;
  bring_online();
  expect_refused(finish(stop_by(Writer::Way::mqtt)), ErrorKind::forbidden);
  EXPECT_TRUE(sdo_writes().empty());
}

TEST_F(StopFirstTest, OneForAllIsTheFirstStopOfTheProfile) {
  bring_online();
  EXPECT_TRUE(finish(support::spawn(loop_.executor(), drive_->stop_motor(origin()))).has_value());
  EXPECT_EQ(slave_.value(test::kControl), kStop);
}

/// Runs of two writers, set-points and stops of a third in random order, each run with a word of its own.
class RandomOrderTest : public StopFirstTest, public testing::WithParamInterface<bool> {
 protected:
  struct Given {
    Sent sent;
    Raw word = 0;  ///< Of a run; of a stop the newest run before it; 0: set-points only.
    bool stop = false;
    bool told = false;
  };

  RandomOrderTest() { model_.commands.deadline = 400ms; }

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
    holds_ = 0;
  }

  Duration delay_{};
  std::size_t heard_ = 0;
  std::multimap<canopen::TimePoint, Raw> effects_;
  std::vector<Raw> on_bus_;
  std::vector<Given> given_;
  std::optional<Raw> stopped_;  ///< Runs up to this word are older than a confirmed stop.
  Raw next_word_ = 100;
  Raw holds_ = 0;
  int by_sdo_ = 0;
  std::map<std::string, int> outcomes_;
};

TEST_P(RandomOrderTest, AfterAConfirmedStopNoOlderRunIsOnTheBusOrTakesEffect) {
  bring_online();
  show(test::kRunningBit);
  const bool slow = GetParam();
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
  EXPECT_GE(outcomes_["run superseded"], 100) << testing::PrintToString(outcomes_);
  EXPECT_GE(outcomes_["run ok"], 500) << testing::PrintToString(outcomes_);
  EXPECT_GE(outcomes_["stop ok"], 500) << testing::PrintToString(outcomes_);
}

INSTANTIATE_TEST_SUITE_P(SdoTask, RandomOrderTest, testing::Bool(),
                         [](const auto& each) { return each.param ? "Slow" : "Prompt"; });

}  // namespace
}  // namespace process
