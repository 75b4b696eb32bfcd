#include "daemon/log.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>

#include "tests/unit/daemon/descriptor.h"
#include "tests/unit/daemon/environment.h"

namespace gateway {
namespace {

using testing::MatchesRegex;

class LogTest : public testing::Test {
 protected:
  // The end of a Log ends all logging of the process; the next test has it again.
  ~LogTest() override { spdlog::set_default_logger(before_); }

  /// What is written while a Log lives, to a file or to what counts as the journal.
  template <class Work>
  static std::string written(bool verbose, Work work, bool to_journal = false) {
    testing::internal::CaptureStderr();
    {
      const test::Environment journal("JOURNAL_STREAM",
                                      to_journal ? std::optional(test::as_journal(STDERR_FILENO)) : std::nullopt);
      const Log log(verbose);
      work();
    }
    return testing::internal::GetCapturedStderr();
  }
  static void speak_at_every_level() {
    spdlog::debug("looks");
    spdlog::info("works");
    spdlog::warn("wonders");
    spdlog::error("fails");
    spdlog::critical("ends");
  }

  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  test::Environment no_journal_{"JOURNAL_STREAM", std::nullopt};
};

TEST_F(LogTest, TellsTheJournalThePriorityOfEachLine) {
  EXPECT_EQ(written(true, speak_at_every_level, true), "<7>looks\n<6>works\n<4>wonders\n<3>fails\n<2>ends\n");
}

TEST_F(LogTest, LeavesOutDebugMessagesUnlessAsked) {
  EXPECT_EQ(written(false, speak_at_every_level, true), "<6>works\n<4>wonders\n<3>fails\n<2>ends\n");
}

TEST_F(LogTest, GivesTimeAndLevelElsewhere) {
  EXPECT_THAT(written(false, [] { spdlog::warn("wonders"); }),
              MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}\\.[0-9]{3} warning wonders\n"));
}

TEST_F(LogTest, WaitsForNobodyAndCountsWhatItDrops) {
  test::Pipe stalled = test::make_pipe();
  const int size = ::fcntl(stalled.in.get(), F_SETPIPE_SZ, 4096);
  ASSERT_GT(size, 0);
  std::size_t dropped = 0;
  std::string read;
  {
    // Nobody reads standard error until all is said: a writer that waited would wait for ever.
    const test::Redirected error(STDERR_FILENO, stalled.in);
    const Log log(false);
    EXPECT_EQ(Log::dropped(), 0U);
    for (int i = 0; i < 20000; ++i) {
      spdlog::info("message {}", i);
    }
    dropped = Log::dropped();
    stalled.in.close();
    std::array<char, 65536> buffer{};
    while (read.find("message 19999\n") == std::string::npos) {
      const ssize_t length = ::read(stalled.out.get(), buffer.data(), buffer.size());
      ASSERT_GT(length, 0);
      read.append(buffer.data(), static_cast<std::size_t>(length));
    }
  }
  EXPECT_GT(dropped, 10000U);
  EXPECT_NE(read.find("message 19999\n"), std::string::npos) << "the newest stay";
  EXPECT_EQ(static_cast<std::size_t>(std::count(read.begin(), read.end(), '\n')) + dropped, 20000U);
}

}  // namespace
}  // namespace gateway
