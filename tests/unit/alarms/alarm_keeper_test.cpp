#include "bridges/alarms/alarm_keeper.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "tests/unit/alarms/memory_bench.h"
#include "tests/unit/journal/loop.h"

namespace alarms {
namespace {

using namespace std::chrono_literals;
using Call = MemoryBench::Call;

class AlarmKeeperTest : public ::testing::Test {
 protected:
  AlarmMemory open(std::chrono::milliseconds patience = 20s) {
    keeper_ = std::make_unique<AlarmKeeper>(
        loop_.executor(), KeptAt{.directory = bench_.state(), .calls = bench_.calls(), .load_patience = patience},
        [this](const std::string& text) { told_.push_back(text); });
    AlarmMemory memory = keeper_->load();
    keeper_->start([this] {
      ++snapshots_;
      return memory_with(count_);
    });
    loop_.hand().settle();
    return memory;
  }
  void begin_or_end(std::uint32_t count) {
    count_ = count;
    keeper_->on_begin_or_end();
  }
  void change(std::uint32_t count) {
    count_ = count;
    keeper_->on_change();
  }
  [[nodiscard]] bool written(std::uint32_t count) const {
    return MemoryBench::text_of(bench_.file()) == memory_text(memory_with(count));
  }
  [[nodiscard]] bool until_written(std::uint32_t count) {
    return loop_.run_until([&] { return written(count); });
  }
  [[nodiscard]] bool until_told(std::size_t times) {
    return loop_.run_until([&] { return told_.size() == times; });
  }
  void hang_in_first_write() {
    bench_.hang();
    begin_or_end(1);
    ASSERT_TRUE(loop_.run_until([this] { return snapshots_ == 1; }));
    bench_.await_hanging();
  }
  /// Time goes on while the thread works: what is tried again is due some time after an attempt has ended.
  template <class Predicate>
  [[nodiscard]] bool in_time(Predicate done) {
    for (int i = 0; i < 2000 && !done(); ++i) {
      pass(100ms);
      loop_.hand().context().run_one_for(5ms);
    }
    return done();
  }
  void pass(canopen::Duration time) { loop_.hand().advance(time); }
  void expect_told(std::size_t which, const std::string& text) {
    ASSERT_GT(told_.size(), which);
    EXPECT_NE(told_[which].find(text), std::string::npos) << told_[which];
  }

  MemoryBench bench_;
  journal::LoopWithThread loop_;
  std::unique_ptr<AlarmKeeper> keeper_;
  std::uint32_t count_ = 0;
  int snapshots_ = 0;
  std::vector<std::string> told_;
};

TEST_F(AlarmKeeperTest, WithoutAFileNothingIsKnownAndNothingIsWrong) {
  EXPECT_EQ(open(), AlarmMemory{});
  EXPECT_TRUE(told_.empty());
}

TEST_F(AlarmKeeperTest, WhatWasKeptIsThereAfterTheNextStart) {
  static_cast<void>(open());
  begin_or_end(1);
  ASSERT_TRUE(until_written(1));
  keeper_.reset();
  EXPECT_EQ(open(), memory_with(1));
  EXPECT_TRUE(told_.empty());
}

TEST_F(AlarmKeeperTest, ABeginIsWrittenAtOnceTheRestAfterTenSeconds) {
  static_cast<void>(open());
  begin_or_end(1);
  ASSERT_TRUE(until_written(1));
  change(2);
  pass(9s);
  change(3);
  pass(900ms);
  EXPECT_TRUE(written(1));
  pass(100ms);
  ASSERT_TRUE(until_written(3));
  change(4);
  pass(1s);
  EXPECT_TRUE(written(3));
  begin_or_end(5);
  ASSERT_TRUE(until_written(5));
  EXPECT_EQ(snapshots_, 3);
}

TEST_F(AlarmKeeperTest, AStormIsNeverQueued) {
  static_cast<void>(open());
  hang_in_first_write();
  for (std::uint32_t i = 2; i <= 1000; ++i) {
    begin_or_end(i);
    pass(1ms);
  }
  EXPECT_EQ(snapshots_, 1);
  bench_.go_on();
  ASSERT_TRUE(until_written(1000));
  EXPECT_EQ(snapshots_, 2);
  for (std::uint32_t i = 1; i <= 1000; ++i) {  // a disk as fast as can be
    begin_or_end(1000 + i);
    pass(1ms);
  }
  EXPECT_LE(snapshots_, 2 + 11) << "ten a second";
  for (int i = 0; i < 2; ++i) {  // behind the one that may be under way
    const int before = snapshots_;
    pass(AlarmKeeper::kSpacing);
    ASSERT_TRUE(loop_.run_until([&] { return snapshots_ > before || written(2000); }));
  }
  EXPECT_TRUE(until_written(2000));
}

TEST_F(AlarmKeeperTest, AFullDiskIsToldOnceAndTriedAgain) {
  static_cast<void>(open());
  begin_or_end(1);
  ASSERT_TRUE(until_written(1));
  bench_.refuse(Call::write, ENOSPC);
  pass(1s);
  begin_or_end(2);
  ASSERT_TRUE(until_told(1));
  expect_told(0, "No space left on device; alarms are not kept meanwhile");
  ASSERT_TRUE(in_time([this] { return snapshots_ >= 10; })) << "tried again";
  EXPECT_EQ(told_.size(), 1U);
  EXPECT_TRUE(written(1));
  bench_.accept();
  ASSERT_TRUE(in_time([this] { return told_.size() == 2; }));
  expect_told(1, "alarms are kept again");
  EXPECT_TRUE(written(2));
}

TEST_F(AlarmKeeperTest, ADiskThatHangsHoldsNobodyUpAndIsTold) {
  static_cast<void>(open());
  hang_in_first_write();
  pass(4900ms);
  EXPECT_TRUE(told_.empty());
  pass(200ms);
  ASSERT_EQ(told_.size(), 1U);
  expect_told(0, "does not answer");
  const auto stopped = loop_.start(keeper_->stop());
  pass(999ms);
  EXPECT_FALSE(*stopped);
  pass(1ms);
  EXPECT_TRUE(*stopped);
}

TEST_F(AlarmKeeperTest, ADiskThatGoesOnIsToldAndWhatCameMeanwhileIsKept) {
  static_cast<void>(open());
  hang_in_first_write();
  begin_or_end(2);
  pass(6s);
  bench_.go_on();
  ASSERT_TRUE(until_written(2));
  ASSERT_EQ(told_.size(), 2U);
  expect_told(1, "kept again");
}

TEST_F(AlarmKeeperTest, AStartBesideADiskThatHangsGoesOnWithoutMemory) {
  bench_.put(memory_text(memory_with(1)));
  bench_.hang();
  EXPECT_EQ(open(1ms), AlarmMemory{});
  ASSERT_EQ(told_.size(), 1U);
  expect_told(0, "does not answer; nothing is known of alarms before this start");
  begin_or_end(2);
  pass(60s);
  EXPECT_EQ(snapshots_, 0);
  bench_.go_on();
  ASSERT_TRUE(until_written(2));
}

TEST_F(AlarmKeeperTest, ATornFileIsSetAsideAndCountsAsNone) {
  const std::string text = memory_text(memory_with(1));
  bench_.put(text.substr(0, text.size() / 2));
  EXPECT_EQ(open(), AlarmMemory{});
  ASSERT_EQ(told_.size(), 1U);
  expect_told(0, "alarms.json: it is no JSON");
  expect_told(0, "it is now alarms.json.bad");
  EXPECT_EQ(MemoryBench::text_of(bench_.bad()), text.substr(0, text.size() / 2));
  begin_or_end(2);
  ASSERT_TRUE(until_written(2));
}

TEST_F(AlarmKeeperTest, AnEmptyFileIsATornOne) {
  bench_.put("");
  EXPECT_EQ(open(), AlarmMemory{});
  ASSERT_EQ(told_.size(), 1U);
  expect_told(0, "it is now alarms.json.bad");
}

TEST_F(AlarmKeeperTest, AFileThatCannotBeReadIsSetAside) {
  bench_.put(memory_text(memory_with(1)));
  bench_.refuse(Call::read, EIO);
  EXPECT_EQ(open(), AlarmMemory{});
  ASSERT_EQ(told_.size(), 1U);
  expect_told(0, "Input/output error; it is now alarms.json.bad");
  EXPECT_TRUE(std::filesystem::exists(bench_.bad()));
}

TEST_F(AlarmKeeperTest, TwoProcessesDoNotShareADirectory) {
  static_cast<void>(open());
  begin_or_end(1);
  ASSERT_TRUE(until_written(1));
  std::unique_ptr<AlarmKeeper> first = std::move(keeper_);
  EXPECT_EQ(open(), AlarmMemory{}) << "it reads nothing";
  ASSERT_EQ(told_.size(), 1U);
  expect_told(0, "is in use by another process; alarms are not kept");
  begin_or_end(2);
  ASSERT_TRUE(in_time([this] { return snapshots_ >= 6; }));
  EXPECT_TRUE(written(1)) << "nor does it write";
  EXPECT_EQ(told_.size(), 1U);
  first.reset();
  ASSERT_TRUE(in_time([this] { return written(2); })) << "it takes over";
  ASSERT_TRUE(until_told(2));
}

TEST_F(AlarmKeeperTest, AnUnusableDirectoryIsToldOnce) {
  std::ofstream(bench_.state()) << "x";
  EXPECT_EQ(open(), AlarmMemory{});
  ASSERT_EQ(told_.size(), 1U);
  expect_told(0, "Not a directory; alarms are not kept");
  begin_or_end(1);
  ASSERT_TRUE(loop_.run_until([&] { return snapshots_ == 1; }));
  EXPECT_EQ(told_.size(), 1U);
}

TEST_F(AlarmKeeperTest, TheEndWritesWhatWaits) {
  static_cast<void>(open());
  begin_or_end(1);
  ASSERT_TRUE(until_written(1));
  change(2);
  const auto stopped = loop_.start(keeper_->stop());
  pass(AlarmKeeper::kSpacing);
  ASSERT_TRUE(loop_.run_until([&] { return *stopped; }));
  EXPECT_TRUE(written(2));
}

TEST_F(AlarmKeeperTest, TheEndDoesNotWaitForADiskThatRefuses) {
  static_cast<void>(open());
  bench_.refuse(Call::write, ENOSPC);
  begin_or_end(1);
  ASSERT_TRUE(until_told(1));
  pass(AlarmKeeper::kSpacing);
  const auto stopped = loop_.start(keeper_->stop());
  ASSERT_TRUE(loop_.run_until([&] { return *stopped; }));
  ASSERT_EQ(told_.size(), 2U);
  expect_told(1, "the last changes of alarms are not kept");
}

}  // namespace
}  // namespace alarms
