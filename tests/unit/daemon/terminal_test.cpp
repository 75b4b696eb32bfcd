#include "daemon/terminal.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>

#include "tests/unit/daemon/descriptor.h"
#include "tests/unit/daemon/program.h"

namespace gateway {
namespace {

bool blocks(int descriptor) {
  return (::fcntl(descriptor, F_GETFL) & O_NONBLOCK) == 0;
}

TEST(Reopen, LeavesAPipeAsItIs) {
  const test::Pipe pipe = test::make_pipe();
  const test::Descriptor reading(reopen(pipe.out.get(), O_RDONLY));
  const test::Descriptor writing(reopen(pipe.in.get(), O_WRONLY));
  ASSERT_GE(reading.get(), 0);
  ASSERT_GE(writing.get(), 0);
  EXPECT_FALSE(blocks(reading.get()));
  EXPECT_FALSE(blocks(writing.get()));
  EXPECT_TRUE(blocks(pipe.out.get()));
  EXPECT_TRUE(blocks(pipe.in.get()));
  ASSERT_EQ(::write(writing.get(), "x", 1), 1);
  char got = 0;
  EXPECT_EQ(::read(pipe.out.get(), &got, 1), 1) << "it is the same pipe";
}

TEST(Reopen, LeavesAFileToItsOffset) {
  const test::TemporaryFile file("text");
  const test::Descriptor open(::open(file.path().c_str(), O_RDWR | O_CLOEXEC));
  EXPECT_EQ(reopen(open.get(), O_WRONLY), -1);
}

TEST(Reopen, CannotHaveASocketOrAClosedOne) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
  const test::Descriptor one(ends[0]);
  const test::Descriptor other(ends[1]);
  EXPECT_EQ(reopen(one.get(), O_RDONLY), -1);
  EXPECT_EQ(reopen(-1, O_RDONLY), -1);
}

TEST(MayReadTerminal, WhatIsNoTerminalMayAlwaysBeRead) {
  const test::Pipe pipe = test::make_pipe();
  EXPECT_TRUE(may_read_terminal(pipe.out.get()));
}

}  // namespace
}  // namespace gateway
