#include "daemon/output.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <string>

#include "canopen/bus/socketcan/descriptor.h"

namespace gateway {
namespace {

using canopen::socketcan::Descriptor;
using std::chrono::milliseconds;

constexpr milliseconds kNone(0);

/// A pipe whose ends do not block.
class OutputTest : public testing::Test {
 protected:
  OutputTest() {
    std::signal(SIGPIPE, SIG_IGN);
    std::array<int, 2> ends{-1, -1};
    EXPECT_EQ(::pipe2(ends.data(), O_NONBLOCK), 0);
    reader_ = Descriptor(ends[0]);
    writer_ = Descriptor(ends[1]);
  }
  ~OutputTest() override { std::signal(SIGPIPE, SIG_DFL); }

  /// All that waits in the pipe.
  std::string read() const {
    std::string text(std::size_t{1} << 20U, '\0');
    const ssize_t length = ::read(reader_.get(), text.data(), text.size());
    return text.substr(0, static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
  }

  Descriptor reader_;
  Descriptor writer_;
  /// More than a pipe takes.
  const std::string flood_ = std::string(std::size_t{1} << 20U, 'x');
};

TEST_F(OutputTest, WritesAll) {
  EXPECT_FALSE(write_text(writer_.get(), "one\ntwo\n", kNone));
  EXPECT_EQ(read(), "one\ntwo\n");
}

TEST_F(OutputTest, SaysThatTheDiskIsFull) {
  const Descriptor full(::open("/dev/full", O_WRONLY));
  EXPECT_EQ(write_text(full.get(), "text", kNone), std::errc::no_space_on_device);
}

TEST_F(OutputTest, SaysThatTheReaderIsGone) {
  reader_ = Descriptor();
  EXPECT_EQ(write_text(writer_.get(), "text", kNone), std::errc::broken_pipe);
}

TEST_F(OutputTest, GivesUpOnAReaderThatStandsStill) {
  EXPECT_EQ(write_text(writer_.get(), flood_, kNone), std::errc::timed_out);
  EXPECT_FALSE(read().empty());
  EXPECT_FALSE(write_text(writer_.get(), "more", kNone)) << "there is room again";
}

TEST_F(OutputTest, LiveOutputEndsWithItsFirstFailure) {
  int failures = 0;
  LiveOutput output(writer_.get(), [&failures] { ++failures; });
  output.write("text");
  EXPECT_NO_THROW(output.require_written());
  reader_ = Descriptor();
  output.write("lost");
  output.write("lost too");
  EXPECT_EQ(failures, 1);
  try {
    output.require_written();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const std::system_error& error) {
    EXPECT_STREQ(error.what(), "standard output: Broken pipe");
  }
}

TEST_F(OutputTest, LiveOutputKeepsWhatAReaderThatStandsStillDoesNotTake) {
  LiveOutput output(writer_.get(), [] { ADD_FAILURE() << "no failure"; });
  const std::string table(std::size_t{100} * 1024, 't');  // a pipe takes 64 KiB
  output.write(table);
  output.write("kept");
  std::string seen = read();
  EXPECT_LT(seen.size(), table.size());
  output.write("seen");
  seen += read();
  EXPECT_EQ(seen, table + "keptseen");
}

TEST_F(OutputTest, LiveOutputLeavesOutWhatIsTooMuch) {
  LiveOutput output(writer_.get(), [] { ADD_FAILURE() << "no failure"; });
  output.write(flood_);
  EXPECT_EQ(read(), "");
  output.write("seen");
  EXPECT_EQ(read(), "seen");
}

TEST_F(OutputTest, LiveOutputLeavesTheDescriptorAsItIs) {
  ASSERT_EQ(::fcntl(writer_.get(), F_SETFL, 0), 0);  // it blocks
  LiveOutput output(writer_.get(), [] { ADD_FAILURE() << "no failure"; });
  output.write(std::string(std::size_t{200} * 1024, 't'));
  EXPECT_EQ(::fcntl(writer_.get(), F_GETFL) & O_NONBLOCK, 0);
  EXPECT_FALSE(read().empty());
}

}  // namespace
}  // namespace gateway
