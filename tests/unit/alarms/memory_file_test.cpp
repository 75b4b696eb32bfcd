#include "bridges/alarms/memory_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cerrno>
#include <optional>
#include <string>
#include <vector>

#include "tests/unit/alarms/memory_bench.h"

namespace alarms {
namespace {

using Names = std::vector<std::string>;

class MemoryFileTest : public ::testing::Test {
 protected:
  void write(const std::string& text) {
    const MemoryFile::Failure failure = file_.write(text);
    EXPECT_FALSE(failure) << *failure;
  }
  /// A write that fails leaves the old file, and no other.
  void expect_refused(const std::string& why) {
    const MemoryFile::Failure failure = file_.write("new text");
    ASSERT_TRUE(failure);
    EXPECT_NE(failure->find(why), std::string::npos) << *failure;
    EXPECT_EQ(MemoryBench::text_of(bench_.file()), "old");
    EXPECT_EQ(bench_.names(), Names{"alarms.json"});
  }
  [[nodiscard]] std::optional<std::string> read() {
    std::optional<std::string> text;
    EXPECT_FALSE(file_.open());
    EXPECT_FALSE(file_.read(text));
    return text;
  }

  MemoryBench bench_;
  MemoryFile file_{bench_.state(), bench_.calls()};
};

TEST_F(MemoryFileTest, MakesItsDirectoryAndReadsWhatItWrote) {
  EXPECT_EQ(read(), std::nullopt);
  write("one");
  write("two and more");
  EXPECT_EQ(read(), "two and more");
  EXPECT_EQ(bench_.names(), Names{"alarms.json"});
  struct stat status{};
  ASSERT_EQ(stat(bench_.file().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U & ~0640U, 0U);
}

TEST_F(MemoryFileTest, AFullDiskLeavesTheOldOne) {
  write("old");
  bench_.refuse(MemoryBench::Call::write, ENOSPC, 3);
  expect_refused("alarms.json.new: No space left on device");
  bench_.accept();
  write("new");
  EXPECT_EQ(read(), "new");
}

TEST_F(MemoryFileTest, WhatDoesNotReachTheDiskDoesNotReplaceTheOldOne) {
  write("old");
  bench_.refuse(MemoryBench::Call::sync, EIO);
  expect_refused("cannot bring");
}

TEST_F(MemoryFileTest, ARenameThatFailsLeavesTheOldOne) {
  write("old");
  bench_.refuse(MemoryBench::Call::rename, EROFS);
  expect_refused("cannot rename");
}

TEST_F(MemoryFileTest, WhatACrashLeftDisturbsNothing) {
  write("old");
  std::filesystem::copy_file(bench_.file(), bench_.state() / "alarms.json.new");
  EXPECT_EQ(read(), "old");
  write("x");
  EXPECT_EQ(read(), "x");
  EXPECT_EQ(bench_.names(), Names{"alarms.json"});
}

TEST_F(MemoryFileTest, AReadThatFailsIsTold) {
  write("old");
  bench_.refuse(MemoryBench::Call::read, EIO);
  std::optional<std::string> text;
  const MemoryFile::Failure failure = file_.read(text);
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find("cannot read"), std::string::npos);
}

TEST_F(MemoryFileTest, IsSetAsideInPlaceOfAnOlderOne) {
  write("one");
  EXPECT_FALSE(file_.set_aside());
  EXPECT_EQ(read(), std::nullopt);
  write("two");
  EXPECT_FALSE(file_.set_aside());
  EXPECT_EQ(MemoryBench::text_of(bench_.bad()), "two");
  EXPECT_EQ(bench_.names(), Names{"alarms.json.bad"});
}

TEST_F(MemoryFileTest, ADirectoryBelongsToOneAtATime) {
  auto first = std::make_unique<MemoryFile>(bench_.state(), bench_.calls());
  EXPECT_FALSE(first->write("of the first"));
  const MemoryFile::Failure failure = file_.write("of the second");
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find("is in use by another process"), std::string::npos) << *failure;
  EXPECT_EQ(MemoryBench::text_of(bench_.file()), "of the first");
  first.reset();
  write("of the second");
  EXPECT_EQ(MemoryBench::text_of(bench_.file()), "of the second");
}

TEST_F(MemoryFileTest, ADirectoryThatWasTakenAwayIsMadeAgain) {
  write("one");
  std::filesystem::remove_all(bench_.state());
  write("two");
  EXPECT_EQ(read(), "two");
  MemoryFile other(bench_.state(), bench_.calls());
  EXPECT_TRUE(other.open()) << "and it is locked again";
}

TEST_F(MemoryFileTest, AFileInPlaceOfTheDirectoryIsTold) {
  std::ofstream(bench_.state()) << "x";
  const MemoryFile::Failure failure = file_.open();
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find("cannot open"), std::string::npos) << *failure;
}

}  // namespace
}  // namespace alarms
