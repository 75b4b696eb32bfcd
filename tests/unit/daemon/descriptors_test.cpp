#include "daemon/descriptors.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

#include "tests/unit/daemon/descriptor.h"

namespace gateway {
namespace {

using Level = config::Finding::Level;

/// A pipe's reading end is as good as the journal's socket: only its device and inode count.
class JournalTest : public testing::Test {
 protected:
  JournalTest() { EXPECT_EQ(::pipe(ends_.data()), 0); }
  ~JournalTest() override {
    ::unsetenv("JOURNAL_STREAM");
    ::close(ends_[0]);
    ::close(ends_[1]);
  }

  /// As the service manager does it for a service.
  static void name_as_journal(int descriptor) { ::setenv("JOURNAL_STREAM", test::as_journal(descriptor).c_str(), 1); }

  std::array<int, 2> ends_{-1, -1};
};

TEST_F(JournalTest, IsTheDescriptorThatTheVariableNames) {
  EXPECT_FALSE(is_journal(ends_[0]));
  name_as_journal(ends_[0]);
  EXPECT_TRUE(is_journal(ends_[0]));
  EXPECT_FALSE(is_journal(STDIN_FILENO)) << "another one, as when a service's output goes into a file";
}

TEST_F(JournalTest, AnyOtherTextInTheVariableNamesNone) {
  for (const char* const text : {"", ":", "1", "x:y"}) {
    ::setenv("JOURNAL_STREAM", text, 1);
    EXPECT_FALSE(is_journal(ends_[0])) << text;
  }
  EXPECT_FALSE(is_journal(-1));
}

TEST_F(JournalTest, GetsThePriorityOfEachLine) {
  EXPECT_EQ(with_priority(ends_[0], Level::error, "text"), "text");
  name_as_journal(ends_[0]);
  EXPECT_EQ(with_priority(ends_[0], Level::error, "text"), "<3>text");
  EXPECT_EQ(with_priority(ends_[0], Level::warning, "one\ntwo\n"), "<4>one\n<4>two\n");
  EXPECT_EQ(with_priority(ends_[0], Level::error, ""), "");
}

}  // namespace
}  // namespace gateway
