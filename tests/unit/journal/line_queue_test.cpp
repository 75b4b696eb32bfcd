#include "bridges/journal/line_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "bridges/journal/verify.h"
#include "tests/unit/journal/disk.h"
#include "tests/unit/journal/loop.h"

namespace journal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr milliseconds kStep(1);

class JournalQueue : public testing::Test {
 protected:
  // A hanging write would outlive the test.
  ~JournalQueue() override { disk_.go_on(); }

  void open(std::size_t waiting = 100'000) {
    const Place place{
        .directory = directory_.journal(), .limit = 10'000'000, .waiting = waiting, .calls = disk_.calls()};
    queue_ = std::make_unique<LineQueue>(loop_.executor(), place,
                                         [this](const std::string& text) { told_.push_back(text); });
  }
  std::uint64_t post() { return queue_->post(entry_at(2)); }
  [[nodiscard]] Report report() const {
    std::error_code failure;
    return verify(directory_.journal(), failure);
  }
  TemporaryDirectory directory_;
  Disk disk_;
  LoopWithThread loop_;
  std::vector<std::string> told_;
  std::unique_ptr<LineQueue> queue_;
};

TEST_F(JournalQueue, WhoWaitsForHisLineGoesOnWhenItIsWritten) {
  open();
  const auto ended = loop_.start(queue_->written(post()));
  EXPECT_TRUE(loop_.run_until([&] { return *ended; }));
  EXPECT_EQ(report().newest, 1U);
  EXPECT_EQ(queue_->newest_hash(), report().newest_hash);
  EXPECT_EQ(queue_->passed_by(), 0U);
  EXPECT_THAT(told_, IsEmpty());
}

TEST_F(JournalQueue, ADiskThatHangsIsPassedByAfterFiftyMillisecondsAndTold) {
  open();
  disk_.hang();
  const auto ended = loop_.start(queue_->written(post()));
  disk_.await_hanging();
  loop_.hand().advance(milliseconds(49), kStep);
  EXPECT_FALSE(*ended);
  loop_.hand().advance(milliseconds(1), kStep);
  EXPECT_TRUE(*ended);
  EXPECT_EQ(queue_->passed_by(), 1U);
  EXPECT_THAT(told_, ElementsAre(HasSubstr("longer than 50 ms")));

  const auto next = loop_.start(queue_->written(post()));
  EXPECT_TRUE(*next) << "nobody waits a second time for the same hang";
  EXPECT_EQ(queue_->passed_by(), 2U);
  EXPECT_THAT(told_, SizeIs(1));

  disk_.go_on();
  EXPECT_TRUE(loop_.run_until([&] { return told_.size() == 2; }));
  EXPECT_THAT(told_.back(), HasSubstr("works again; 2 commands did not wait"));
  EXPECT_EQ(report().newest, 2U) << "in order, all of them";
  EXPECT_TRUE(report().sound());
}

TEST_F(JournalQueue, HangsAreToldOnceAMinute) {
  open();
  for (unsigned i = 0; i < 5; ++i) {
    disk_.hang();
    const auto ended = loop_.start(queue_->written(post()));
    disk_.await_hanging();
    loop_.hand().advance(milliseconds(50), kStep);
    EXPECT_TRUE(*ended);
    disk_.go_on();
    ASSERT_TRUE(
        loop_.run_until([&] { return queue_->newest_hash() == report().newest_hash && report().newest == i + 1; }));
    loop_.hand().advance(seconds(10), seconds(1));
  }
  EXPECT_THAT(told_, SizeIs(2)) << "its begin and its end";
}

TEST_F(JournalQueue, WhatDoesNotFitWhileTheDiskHangsIsCountedByALineInItsPlace) {
  open(1000);
  disk_.hang();
  post();
  disk_.await_hanging();
  for (int i = 0; i < 9; ++i) {
    post();
  }
  EXPECT_GT(queue_->lost(), 0U);
  EXPECT_LT(queue_->lost(), 9U);
  disk_.go_on();
  EXPECT_TRUE(loop_.run_until(
      [&] { return report().lost == queue_->lost() && report().newest_hash == queue_->newest_hash(); }));
  post();
  EXPECT_TRUE(loop_.run_until([&] { return report().newest == 10 - queue_->lost() + 2; }));
  EXPECT_TRUE(report().sound()) << report().broken;
}

TEST_F(JournalQueue, AFullDiskDelaysNobodyAndIsTriedAgainEachSecond) {
  open();
  disk_.refuse(ENOSPC, 40);
  const auto ended = loop_.start(queue_->written(post()));
  EXPECT_TRUE(loop_.run_until([&] { return *ended; })) << "without any time passing";
  EXPECT_EQ(queue_->passed_by(), 1U);
  EXPECT_THAT(told_, ElementsAre(HasSubstr("No space left on device; commands go on")));
  const auto next = loop_.start(queue_->written(post()));
  EXPECT_TRUE(*next);
  disk_.accept();
  loop_.hand().advance(milliseconds(999), kStep);
  EXPECT_EQ(report().newest, 0U);
  loop_.hand().advance(milliseconds(1), kStep);
  EXPECT_TRUE(loop_.run_until([&] { return told_.size() == 2; }));
  EXPECT_EQ(report().newest, 2U);
  EXPECT_TRUE(report().sound()) << report().broken;
  EXPECT_THAT(report().remarks, IsEmpty());
}

TEST_F(JournalQueue, AMissingDirectoryIsToldOnceAndAtTheStart) {
  const Place place{.directory = directory_.path() / "none" / "journal" / "journal", .calls = disk_.calls()};
  LineQueue queue(loop_.executor(), place, [this](const std::string& text) { told_.push_back(text); });
  queue.start();
  EXPECT_TRUE(loop_.run_until([&] { return !told_.empty(); }));
  EXPECT_THAT(told_, ElementsAre(HasSubstr("No such file or directory")));
  for (int i = 0; i < 300; ++i) {
    const auto ended = loop_.start(queue.written(queue.post(entry_at(2))));
    ASSERT_TRUE(loop_.run_until([&] { return *ended; }));
    loop_.hand().advance(seconds(1), seconds(1));
  }
  EXPECT_THAT(told_, SizeIs(1));
  std::filesystem::create_directories(directory_.path() / "none");
  loop_.hand().advance(seconds(1), seconds(1));
  EXPECT_TRUE(loop_.run_until([&] {
    loop_.hand().advance(seconds(1), seconds(1));
    return told_.size() == 2;
  })) << "it is looked for again";
}

TEST_F(JournalQueue, ADirectoryThatComesBeforeTheFirstCommandIsUsedForIt) {
  const Place place{.directory = directory_.path() / "none" / "state" / "journal", .calls = disk_.calls()};
  LineQueue queue(loop_.executor(), place, [this](const std::string& text) { told_.push_back(text); });
  queue.start();
  ASSERT_TRUE(loop_.run_until([&] { return !told_.empty(); }));
  std::filesystem::create_directories(directory_.path() / "none");
  const auto ended = loop_.start(queue.written(queue.post(entry_at(2))));
  ASSERT_TRUE(loop_.run_until([&] { return *ended; }));
  EXPECT_EQ(queue.passed_by(), 0U);
}

TEST_F(JournalQueue, SyncsOnceASecondAndOnlyWhatIsNew) {
  open();
  for (int i = 0; i < 5; ++i) {
    const auto ended = loop_.start(queue_->written(post()));
    ASSERT_TRUE(loop_.run_until([&] { return *ended; }));
  }
  EXPECT_EQ(disk_.syncs(), 0U);
  loop_.hand().advance(seconds(1), milliseconds(100));
  const auto synced = loop_.start(queue_->until_synced(canopen::kNever));
  EXPECT_TRUE(loop_.run_until([&] { return *synced; }));
  EXPECT_EQ(disk_.syncs(), 1U);
  loop_.hand().advance(seconds(10), milliseconds(100));
  EXPECT_EQ(disk_.syncs(), 1U);
}

TEST_F(JournalQueue, ASyncThatFailsIsTold) {
  open();
  disk_.refuse_sync(EIO);
  const auto ended = loop_.start(queue_->written(post()));
  ASSERT_TRUE(loop_.run_until([&] { return *ended; }));
  loop_.hand().advance(seconds(1), milliseconds(100));
  EXPECT_TRUE(loop_.run_until([&] { return !told_.empty(); }));
  EXPECT_THAT(told_.front(), HasSubstr("Input/output error"));
}

TEST_F(JournalQueue, AtAnEndItWaitsForTheDiskAndNotForOneThatHangs) {
  open();
  post();
  auto synced = loop_.start(queue_->until_synced(canopen::Clock::now() + seconds(1)));
  EXPECT_TRUE(loop_.run_until([&] { return *synced; }));
  EXPECT_EQ(disk_.syncs(), 1U);
  disk_.hang();
  post();
  synced = loop_.start(queue_->until_synced(canopen::Clock::now() + seconds(1)));
  disk_.await_hanging();
  loop_.hand().advance(milliseconds(999), kStep);
  EXPECT_FALSE(*synced);
  loop_.hand().advance(milliseconds(1), kStep);
  EXPECT_TRUE(*synced);
}

}  // namespace
}  // namespace journal
