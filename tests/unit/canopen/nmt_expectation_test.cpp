// What a heard NMT state means, as a table: what was before, what is heard, what it means, and whether the node may be
// started afterwards.

#include "canopen/node/nmt_expectation.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "canopen/node/restart.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr Duration kSettling = 1500ms;
const TimePoint kStart{};

enum class Event : std::uint8_t {
  boot_up,
  operational,
  pre_operational,
  stopped,
  unknown,
  start_left,
  stop_given,
  stop_left,
  reset_left,
  boot_begun,
  interrupted_for_boot,
  start_wanted,
  settled  ///< The settling time passes.
};

class Story {
 public:
  void tell(const std::vector<Event>& events) {
    for (const Event event : events) {
      tell(event);
    }
  }
  void tell(Event event) {
    now_ += 10ms;
    switch (event) {
      case Event::boot_up:
        return expectation.begin_anew();
      case Event::operational:
        return hear(NmtState::operational);
      case Event::pre_operational:
        return hear(NmtState::pre_operational);
      case Event::stopped:
        return hear(NmtState::stopped);
      case Event::unknown:
        return hear(NmtState::unknown);
      case Event::start_left:
        return expectation.leave(NmtCommand::start, now_);
      case Event::stop_given:
        return expectation.give(NmtCommand::stop, now_ + 800ms);
      case Event::stop_left:
        return expectation.leave(NmtCommand::stop, now_);
      case Event::reset_left:
        return expectation.leave(NmtCommand::reset_node, now_);
      case Event::boot_begun:
        return expectation.begin_boot();
      case Event::interrupted_for_boot:
        return expectation.interrupt_for_boot(now_);
      case Event::start_wanted:
        return expectation.want_start();
      case Event::settled:
        now_ += kSettling + 800ms;
        return;
    }
  }

  NmtExpectation expectation{kSettling};
  StateMeaning meaning = StateMeaning::usual;

 private:
  void hear(NmtState state) { meaning = expectation.hear(state, now_); }

  TimePoint now_ = kStart + 1h;
};

struct Case {
  const char* what;
  std::vector<Event> before;
  Event heard;
  StateMeaning meaning;
  bool may_start;
};

TEST(NmtExpectation, SaysWhatAHeardStateMeans) {
  using enum Event;
  const std::vector<Case> cases{
      {"found as it boots", {boot_up}, pre_operational, StateMeaning::usual, true},
      {"found running", {}, operational, StateMeaning::started, true},
      {"it goes on running", {operational}, operational, StateMeaning::usual, true},
      {"started by us", {boot_up, pre_operational, start_left}, operational, StateMeaning::usual, true},
      {"started by somebody else", {boot_up, pre_operational}, operational, StateMeaning::started, true},
      {"our start has not shown yet", {boot_up, start_left}, pre_operational, StateMeaning::usual, true},
      {"our start never shows", {boot_up, start_left, settled}, pre_operational, StateMeaning::left, false},
      {"it leaves by itself", {operational}, pre_operational, StateMeaning::left, false},
      {"it is stopped by somebody else", {operational}, stopped, StateMeaning::left, false},
      {"it stays away", {operational, pre_operational}, pre_operational, StateMeaning::usual, false},
      {"somebody starts what had left", {operational, pre_operational}, operational, StateMeaning::started_again, true},
      {"a boot-up ends what had left",
       {operational, pre_operational, boot_up},
       pre_operational,
       StateMeaning::usual,
       true},
      {"a start command ends what had left",
       {operational, pre_operational, start_wanted},
       pre_operational,
       StateMeaning::usual,
       true},
      {"our stop shows", {operational, stop_given, stop_left}, stopped, StateMeaning::usual, false},
      {"it stops before our stop is told to have left", {operational, stop_given}, stopped, StateMeaning::usual, false},
      {"a message crosses our stop", {operational, stop_given, stop_left}, operational, StateMeaning::usual, false},
      {"it does not obey our stop", {operational, stop_left, settled}, operational, StateMeaning::started, true},
      {"somebody starts what we stopped", {operational, stop_left, stopped}, operational, StateMeaning::started, true},
      {"our stop of what had left hides nothing",
       {operational, pre_operational, stop_left},
       stopped,
       StateMeaning::usual,
       false},
      {"stop and start, and a message from between",
       {operational, stop_left, start_left},
       stopped,
       StateMeaning::usual,
       true},
      {"a message from before our reset", {operational, reset_left}, operational, StateMeaning::from_before, true},
      {"a reset without boot-up message",
       {operational, reset_left, operational},
       pre_operational,
       StateMeaning::usual,
       true},
      {"a slow one", {operational, reset_left, operational, settled}, pre_operational, StateMeaning::usual, true},
      {"it does not obey our reset", {operational, reset_left, settled}, operational, StateMeaning::started, true},
      {"a message from before its configuration",
       {operational, boot_begun, interrupted_for_boot},
       operational,
       StateMeaning::from_before,
       true},
      {"it is to be configured",
       {operational, boot_begun, interrupted_for_boot},
       pre_operational,
       StateMeaning::usual,
       true},
      {"started while it is configured",
       {operational, boot_begun, interrupted_for_boot, pre_operational},
       operational,
       StateMeaning::started,
       true},
      {"what we stopped stays so through a boot",
       {operational, stop_left, boot_begun, interrupted_for_boot},
       pre_operational,
       StateMeaning::usual,
       false},
      {"what had left stays so through a boot",
       {operational, pre_operational, boot_begun},
       pre_operational,
       StateMeaning::usual,
       false},
      {"a stop behind a start that is not obeyed",
       {boot_up, start_left, stop_left, settled, boot_begun},
       pre_operational,
       StateMeaning::usual,
       false},
      {"a message from between start and stop",
       {boot_up, start_left, stop_left},
       operational,
       StateMeaning::usual,
       false},
      {"a start that is not obeyed",
       {boot_up, start_left, settled, boot_begun},
       pre_operational,
       StateMeaning::usual,
       true},
      {"a start wanted of what runs changes nothing",
       {operational, start_wanted},
       pre_operational,
       StateMeaning::left,
       false},
      {"a number that is no state", {operational}, unknown, StateMeaning::usual, true},
  };
  for (const Case& entry : cases) {
    Story story;
    story.tell(entry.before);
    story.meaning = StateMeaning::from_before;
    story.tell(entry.heard);
    EXPECT_EQ(story.meaning, entry.meaning) << entry.what;
    EXPECT_EQ(story.expectation.may_start(), entry.may_start) << entry.what;
  }
}

TEST(NmtExpectation, OfACommandThatWasNotSentNothingRemains) {
  Story story;
  story.tell(Event::operational);
  const NmtExpectation before = story.expectation;
  story.tell(Event::stop_given);
  EXPECT_FALSE(story.expectation.may_start());
  story.expectation = before;
  story.tell(Event::pre_operational);
  EXPECT_EQ(story.meaning, StateMeaning::left);
}

TEST(Restart, WaitsTwiceAsLongEachTimeUpToAMinute) {
  Restart restart(true);
  TimePoint now = kStart + 1h;
  restart.come_online(now);
  EXPECT_EQ(restart.at(), kNever);
  for (const Duration pause : {5s, 10s, 20s, 40s, 60s, 60s}) {
    restart.leave(now);
    EXPECT_EQ(restart.at(), now + pause);
    now += pause;
    restart.come_online(now);
  }
  now += 60s;
  restart.leave(now);
  EXPECT_EQ(restart.at(), now + 5s) << "it was operational for a minute";
}

TEST(Restart, NotWhereItIsNotWantedOrSomebodyElseCommands) {
  const TimePoint now = kStart + 1h;
  Restart unwanted(false);
  unwanted.leave(now);
  EXPECT_EQ(unwanted.at(), kNever);
  Restart restart(true);
  restart.come_online(now);
  restart.leave(now);
  restart.hear_foreign_nmt();
  EXPECT_EQ(restart.at(), kNever);
  restart.put_off(now);
  EXPECT_EQ(restart.at(), kNever);
  restart.come_online(now);
  restart.leave(now);
  EXPECT_NE(restart.at(), kNever);
}

}  // namespace
}  // namespace canopen
