#include "bridges/recorder/record_keeper.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "tests/unit/journal/loop.h"
#include "tests/unit/recorder/record_bench.h"

namespace recorder {
namespace {

using namespace std::chrono_literals;
using Call = RecordBench::Call;

class RecordKeeperTest : public ::testing::Test {
 protected:
  void open() {
    keeper_ = std::make_unique<RecordKeeper>(loop_.executor(),
                                             KeptAt{.state_directory = bench_.state(), .calls = bench_.calls()},
                                             [this](const std::string& text) { told_.push_back(text); });
    keeper_->start({.kept = [this](const Record& record) { kept_.push_back(to_text(record.name)); },
                    .changed = [this] { ++changed_; }});
  }
  void open_and_look() {
    open();
    ASSERT_TRUE(loop_.run_until([&] { return changed_ == 1; }));
  }
  /// So many further attempts, each when it is due.
  [[nodiscard]] bool tries(int count) {
    for (int i = 0; i < count; ++i) {
      const int before = changed_;
      loop_.hand().advance(RecordKeeper::kTryAgain, 1s);
      if (!loop_.run_until([&] { return changed_ > before; })) {
        return false;
      }
    }
    return true;
  }
  void expect_told(std::size_t which, const std::string& text) {
    ASSERT_GT(told_.size(), which);
    EXPECT_NE(told_[which].find(text), std::string::npos) << told_[which];
  }

  RecordBench bench_;
  journal::LoopWithThread loop_;
  std::unique_ptr<RecordKeeper> keeper_;
  std::vector<std::string> told_;
  std::vector<std::string> kept_;
  int changed_ = 0;
};

TEST_F(RecordKeeperTest, KnowsWhatThereIsAfterItsStart) {
  bench_.put(stem_of(0) + ".log", "");
  open();
  EXPECT_FALSE(keeper_->records());
  ASSERT_TRUE(loop_.run_until([&] { return changed_ == 1; }));
  EXPECT_EQ(keeper_->records()->all().size(), 1U);
  EXPECT_TRUE(keeper_->knows(stem_of(0)));
  EXPECT_FALSE(keeper_->knows(stem_of(1)));
}

TEST_F(RecordKeeperTest, WritesOneBehindTheOther) {
  open_and_look();
  keeper_->post(record_of(0));
  keeper_->post(record_of(1));
  EXPECT_TRUE(keeper_->knows(stem_of(1)));
  ASSERT_TRUE(loop_.run_until([&] { return kept_.size() == 2; }));
  EXPECT_EQ(kept_, (std::vector{stem_of(0), stem_of(1)}));
  EXPECT_EQ(bench_.names().size(), 4U);
  EXPECT_TRUE(told_.empty());
}

TEST_F(RecordKeeperTest, TriesAgainWhenTheDiskIsFullAndTellsItOnce) {
  open_and_look();
  bench_.refuse(Call::write, ENOSPC);
  keeper_->post(record_of(0));
  ASSERT_TRUE(loop_.run_until([&] { return changed_ == 2; }));
  ASSERT_TRUE(tries(2));
  ASSERT_EQ(told_.size(), 1U);
  expect_told(0, "No space left on device; records are not kept meanwhile");
  EXPECT_TRUE(keeper_->records()) << "what there is stays known";
  bench_.accept();
  ASSERT_TRUE(tries(1));
  EXPECT_EQ(kept_.size(), 1U);
  expect_told(1, "records are kept again");
  EXPECT_EQ(keeper_->lost(), 0U);
}

TEST_F(RecordKeeperTest, GivesUpAfterAMinute) {
  open_and_look();
  bench_.refuse(Call::write, EROFS);
  keeper_->post(record_of(0));
  ASSERT_TRUE(loop_.run_until([&] { return changed_ == 2; }));
  ASSERT_TRUE(tries(11));
  EXPECT_EQ(keeper_->lost(), 0U);
  ASSERT_TRUE(tries(1));
  EXPECT_EQ(keeper_->lost(), 1U);
  expect_told(1, "record " + stem_of(0) + " is lost: ");
  EXPECT_FALSE(keeper_->knows(stem_of(0)));
  bench_.accept();
  keeper_->post(record_of(1));
  ASSERT_TRUE(tries(1));
  EXPECT_EQ(kept_.size(), 1U);
}

TEST_F(RecordKeeperTest, ThatTheDirectoryCanBeReadIsNoEndOfAFullDisk) {
  open_and_look();
  bench_.refuse(Call::write, ENOSPC);
  keeper_->post(record_of(0));
  ASSERT_TRUE(loop_.run_until([&] { return changed_ == 2; }));
  EXPECT_FALSE(keeper_->works());
  ASSERT_TRUE(tries(12));
  ASSERT_EQ(keeper_->lost(), 1U);
  ASSERT_TRUE(tries(1)) << "it looks, though nothing waits";
  EXPECT_EQ(told_.size(), 2U) << told_.back();
  EXPECT_FALSE(keeper_->works());
  bench_.accept();
  keeper_->post(record_of(1));
  ASSERT_TRUE(loop_.run_until([&] { return kept_.size() == 1; }));
  EXPECT_TRUE(keeper_->works());
  expect_told(2, "records are kept again");
}

TEST_F(RecordKeeperTest, ADirectoryThatCanBeUsedAgainIsTold) {
  bench_.put_in_the_way();
  open_and_look();
  expect_told(0, "Not a directory; records are not kept meanwhile");
  bench_.clear_the_way();
  ASSERT_TRUE(tries(1));
  expect_told(1, "records are kept again");
}

TEST_F(RecordKeeperTest, ADiskThatHangsCostsTwoRecordsOfABusInMemory) {
  open_and_look();
  bench_.hang();
  keeper_->post(record_of(0));
  bench_.await_hanging();
  keeper_->post(record_of(1));
  keeper_->post(record_of(2));
  keeper_->post(record_of(0, 3, false, 1));
  EXPECT_EQ(keeper_->lost(), 1U);
  expect_told(0, "record " + stem_of(2) + " is lost: those before it are not on the disk yet");
  EXPECT_TRUE(keeper_->works()) << "it may be slow";
  loop_.hand().advance(6s, 100ms);
  expect_told(1, "does not answer; records are not kept meanwhile");
  EXPECT_FALSE(keeper_->works());
  bench_.go_on();
  ASSERT_TRUE(loop_.run_until([&] { return kept_.size() == 3; }));
}

TEST_F(RecordKeeperTest, LooksAgainWhereSomebodyFoundThatOneIsGone) {
  bench_.put(stem_of(0) + ".log", "");
  open_and_look();
  std::filesystem::remove(bench_.records() / (stem_of(0) + ".log"));
  ASSERT_TRUE(keeper_->knows(stem_of(0)));
  keeper_->look();
  ASSERT_TRUE(loop_.run_until([&] { return changed_ == 2; }));
  EXPECT_FALSE(keeper_->knows(stem_of(0)));
}

TEST_F(RecordKeeperTest, TheEndWaitsForTheDisk) {
  open_and_look();
  keeper_->post(record_of(0));
  const auto ended = loop_.start(keeper_->stop());
  ASSERT_TRUE(loop_.run_until([&] { return *ended; }));
  EXPECT_EQ(kept_.size(), 1U);
}

TEST_F(RecordKeeperTest, TheEndWaitsForASecondAndTellsWhatIsLost) {
  open_and_look();
  bench_.hang();
  keeper_->post(record_of(0));
  bench_.await_hanging();
  const auto ended = loop_.start(keeper_->stop());
  loop_.hand().advance(1s, 100ms);
  EXPECT_TRUE(*ended);
  expect_told(0, "record " + stem_of(0) + " is lost: ");
  bench_.go_on();
  ASSERT_TRUE(loop_.run_until([&] { return changed_ == 2; }));
}

TEST_F(RecordKeeperTest, TheEndLeavesNothingThatCannotBeWrittenUntold) {
  open_and_look();
  bench_.refuse(Call::write, ENOSPC);
  keeper_->post(record_of(0));
  const auto ended = loop_.start(keeper_->stop());
  ASSERT_TRUE(loop_.run_until([&] { return *ended; }));
  EXPECT_EQ(keeper_->lost(), 1U);
}

}  // namespace
}  // namespace recorder
