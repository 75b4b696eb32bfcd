// Whatever happens to a node, in whatever order: nothing is started against a stop by command while that stands, every
// command is answered, and the next boot-up brings it online.

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <sstream>
#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class RandomLifeTest : public NodeLifeBench, public testing::WithParamInterface<int> {
 protected:
  using milliseconds = std::chrono::milliseconds;
  struct Incident {
    const char* name;
    void (RandomLifeTest::*act)();
  };

  /// 0 to `end` - 1. The same numbers with every library, unlike its distributions.
  int roll(int end) { return static_cast<int>(random_() % static_cast<unsigned>(end)); }
  bool one_in(int count) { return roll(count) == 0; }

  void start_any();
  void happen();
  void pass(milliseconds time);
  void look_at_nmt();
  void look_at_stop();
  void release();
  void note(const std::string& text) { log_ << (Clock::now() - begun_) / 1ms << " ms " << text << "\n"; }
  [[nodiscard]] std::string story() const { return "seed " + std::to_string(GetParam()) + "\n" + log_.str(); }

  // What may happen to it.
  void reboot();
  void go_operational();
  void go_pre_operational() { tell_state(127); }
  void go_stopped() { tell_state(4); }
  void command_start();
  void command_pre_operational() { give_stop(NmtCommand::pre_operational); }
  void command_stop() { give_stop(NmtCommand::stop); }
  void command_reset();
  void lose_bus();
  void unplug_it();
  void block_transmission();
  void send_any_tpdo();
  void command_by_another_master();
  void mute_it();
  void lose_echoes();
  void tell_state(std::uint8_t state);
  void give_stop(NmtCommand stop);

  static const std::array<Incident, 15> kIncidents;

  std::mt19937 random_{static_cast<unsigned>(GetParam())};
  std::ostringstream log_;
  TimePoint begun_ = Clock::now();
  std::vector<Sent> commands_;
  std::optional<Sent> stop_under_way_;
  bool stop_stands_ = false;
  bool started_against_stop_ = false;
  std::size_t frames_seen_ = 0;
};

const std::array<RandomLifeTest::Incident, 15> RandomLifeTest::kIncidents{{
    {"it reboots", &RandomLifeTest::reboot},
    {"it says operational", &RandomLifeTest::go_operational},
    {"it says pre-operational", &RandomLifeTest::go_pre_operational},
    {"it says stopped", &RandomLifeTest::go_stopped},
    {"start by command", &RandomLifeTest::command_start},
    {"pre-operational by command", &RandomLifeTest::command_pre_operational},
    {"stop by command", &RandomLifeTest::command_stop},
    {"reset by command", &RandomLifeTest::command_reset},
    {"the bus is off", &RandomLifeTest::lose_bus},
    {"it is unplugged", &RandomLifeTest::unplug_it},
    {"nothing of ours can leave", &RandomLifeTest::block_transmission},
    {"it sends a TPDO", &RandomLifeTest::send_any_tpdo},
    {"another master commands", &RandomLifeTest::command_by_another_master},
    {"it answers no SDO", &RandomLifeTest::mute_it},
    {"our echoes are lost", &RandomLifeTest::lose_echoes},
}};

/// A drive of any settings, as wanted or not, found in any state.
void RandomLifeTest::start_any() {
  NodeSettings settings = with_motor();
  settings.restart = one_in(4);
  settings.self_starting = one_in(4);
  settings.reconfigure_running = one_in(4);
  install(settings);
  motor_stands();
  silent_when_stopped();
  if (one_in(2)) {
    slave_.set(kTpdoEventTimer, DataType::u16, 7);
  }
  if (one_in(2)) {
    slave_.set_state(5);
  }
  const milliseconds delay(roll(30));
  slave_.delay_answers(delay);
  log_ << "restart " << settings.restart << ", self_starting " << settings.self_starting << ", reconfigure_running "
       << settings.reconfigure_running << ", event timer " << slave_.value(kTpdoEventTimer) << ", found in state "
       << int{slave_.state()} << ", answers after " << delay.count() << " ms\n";
  start(settings);
}

void RandomLifeTest::happen() {
  const Incident& incident = kIncidents[static_cast<std::size_t>(roll(static_cast<int>(kIncidents.size())))];
  note(incident.name);
  (this->*incident.act)();
  pass(one_in(10) ? 7000ms : milliseconds(roll(600)));
}

void RandomLifeTest::pass(milliseconds time) {
  for (milliseconds passed{}; passed < time; passed += 5ms) {
    loop_.advance(5ms);
    look_at_nmt();
    look_at_stop();
  }
}

void RandomLifeTest::look_at_nmt() {
  for (; frames_seen_ < slave_.heard().size(); ++frames_seen_) {
    const Frame& frame = slave_.heard()[frames_seen_];
    if (frame.id == 0) {
      note("  it hears NMT command " + std::to_string(frame.data[0]));
      started_against_stop_ = started_against_stop_ || (stop_stands_ && frame == nmt(1));
    }
  }
}

/// It stands from its departure on; not where it did not reach the drive.
void RandomLifeTest::look_at_stop() {
  if (stop_under_way_ && stop_under_way_->done()) {
    const Result<void> left = stop_under_way_->get();
    stop_stands_ = left.has_value() && slave_.state() != 5;
    note("  the stop has " + (left.has_value() ? "left" : "not left: " + to_string(left.error())));
    stop_under_way_.reset();
  }
}

/// What happens now may end in a start whatever was commanded before.
void RandomLifeTest::release() {
  stop_stands_ = false;
  stop_under_way_.reset();
}

void RandomLifeTest::reboot() {
  release();
  slave_.boot_up();
}

void RandomLifeTest::go_operational() {
  if (slave_.state() != 4) {  // A stopped one starts by command only.
    release();
    tell_state(5);
  }
}

void RandomLifeTest::tell_state(std::uint8_t state) {
  slave_.set_state(state);
  slave_.send(0x705, {state});
}

void RandomLifeTest::command_start() {
  release();
  commands_.push_back(command(NmtCommand::start, milliseconds(100 + roll(2000))));
}

void RandomLifeTest::give_stop(NmtCommand stop) {
  commands_.push_back(command(stop));
  stop_under_way_ = commands_.back();
}

void RandomLifeTest::command_reset() {
  release();
  commands_.push_back(command(NmtCommand::reset_node));
}

void RandomLifeTest::lose_bus() {
  wire_.set_state({BusCondition::bus_off, 0, 0});
  pass(milliseconds(10 + roll(2500)));
  wire_.set_state({BusCondition::error_active, 0, 0});
  release();  // It may have rebooted unseen.
}

void RandomLifeTest::unplug_it() {
  const milliseconds time(10 + roll(2500));
  slave_.unplug(true);
  pass(time);
  slave_.unplug(false);
  tell_state(slave_.state());  // So that it is lost by now or not at all.
  if (time > 900ms) {
    release();  // Likewise.
  }
}

void RandomLifeTest::block_transmission() {
  closed_ = true;
  pass(milliseconds(roll(400)));
  closed_ = false;
}

void RandomLifeTest::send_any_tpdo() {
  if (slave_.state() == 5) {
    send_tpdo(0x27, 1);
  }
}

void RandomLifeTest::command_by_another_master() {
  const bool starts = one_in(2);
  if (starts) {
    release();
  }
  slave_.send(0x000, {static_cast<std::uint8_t>(starts ? 1 : 128), 0});
  slave_.set_state(starts ? 5 : 127);
}

void RandomLifeTest::mute_it() {
  slave_.mute_sdo(true);
  pass(milliseconds(roll(2500)));
  slave_.mute_sdo(false);
}

void RandomLifeTest::lose_echoes() {
  wire_.withhold_echoes(true);
  pass(milliseconds(roll(300)));
  wire_.withhold_echoes(false);
}

TEST_P(RandomLifeTest, NoStopIsUndoneAndTheNextBootUpBringsItOnline) {
  start_any();
  for (int i = 0; i < 25; ++i) {
    happen();
    ASSERT_FALSE(started_against_stop_) << story();
  }
  pass(4s);
  ASSERT_FALSE(started_against_stop_) << story();
  for (const Sent& sent : commands_) {
    EXPECT_TRUE(sent.done()) << story();
  }
  note("its last boot-up");
  slave_.boot_up();
  const bool well = loop_.advance_until(
      [this] {
        return status().online && status().nmt == NmtState::operational && status().boot_result == BootResult::ok &&
               slave_.state() == 5;
      },
      20s);
  EXPECT_TRUE(well) << "it is in state " << int{slave_.state()} << ", online " << status().online
                    << ", told: " << status().boot_text << "\n"
                    << story();
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomLifeTest, testing::Range(1, 21), testing::PrintToStringParamName());

}  // namespace
}  // namespace canopen
