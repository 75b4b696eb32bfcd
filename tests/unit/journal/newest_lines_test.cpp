#include "bridges/journal/newest_lines.h"

#include <gmock/gmock.h>

#include <fstream>
#include <string>

#include "bridges/journal/line_queue.h"
#include "tests/unit/journal/disk.h"
#include "tests/unit/journal/loop.h"

namespace journal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(NewestLines, AreAsManyAsAreKept) {
  NewestLines newest;
  for (int i = 0; i < 1000; ++i) {
    newest.add(std::to_string(i));
  }
  ASSERT_THAT(newest.lines(), SizeIs(NewestLines::kMostLines));
  EXPECT_EQ(newest.lines().front(), "800");
  EXPECT_EQ(newest.lines().back(), "999");
}

TEST(NewestLines, LongOnesTakeNoMoreMemory) {
  NewestLines newest;
  for (int i = 0; i < 10; ++i) {
    newest.add(std::string(NewestLines::kMostBytes / 3, 'x'));
  }
  EXPECT_THAT(newest.lines(), SizeIs(3));
  newest.add(std::string(NewestLines::kMostBytes + 1, 'x'));
  EXPECT_THAT(newest.lines(), IsEmpty());
}

/// Written by one queue after the other, as by a gateway that is started again.
class NewestLinesOnDisk : public testing::Test {
 protected:
  void open() {
    queue_.reset();
    queue_ = std::make_unique<LineQueue>(
        loop_.executor(), Place{.directory = directory_.journal(), .calls = disk_.calls()}, [](const std::string&) {});
    queue_->start();
  }
  void write(int count) {
    for (int i = 0; i < count; ++i) {
      const auto ended = loop_.start(queue_->written(queue_->post(entry_at(2))));
      ASSERT_TRUE(loop_.run_until([&] { return *ended; }));
    }
  }
  [[nodiscard]] const std::deque<std::string>& lines() { return queue_->newest_lines().lines(); }

  TemporaryDirectory directory_;
  Disk disk_;
  LoopWithThread loop_;
  std::unique_ptr<LineQueue> queue_;
};

TEST_F(NewestLinesOnDisk, OutliveARestart) {
  open();
  write(2);
  EXPECT_THAT(lines(), ElementsAre(HasSubstr("{\"n\":1,"), HasSubstr("{\"n\":2,")));
  EXPECT_EQ(lines().back().back(), '}') << "without a line break";
  open();
  write(1);
  EXPECT_THAT(lines(), ElementsAre(HasSubstr("{\"n\":1,"), HasSubstr("{\"n\":2,"), HasSubstr("{\"n\":3,")));
}

TEST_F(NewestLinesOnDisk, WhatIsNoLineIsLeftOut) {
  open();
  write(1);
  queue_.reset();
  for (const auto& file : std::filesystem::directory_iterator(directory_.journal())) {
    std::ofstream(file.path(), std::ios::app) << "hello\n{\"n\":2,\"ts\":";
  }
  EXPECT_THAT(read_newest_lines(directory_.journal()), ElementsAre(HasSubstr("{\"n\":1,")));
  EXPECT_THAT(read_newest_lines(directory_.journal() / "none"), IsEmpty());
}

}  // namespace
}  // namespace journal
