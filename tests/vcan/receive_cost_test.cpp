// As root: tests/vcan/run BUILD/tests/vcan/socketcan_link_test
// What a burst of frames costs in system calls: each is dear where the kernel is a program, too, or guards itself.
#include <gtest/gtest.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <ctime>

#include "canopen/bus/bus.h"
#include "tests/vcan/link_fixture.h"

namespace {

struct Calls {
  int receive = 0;
  int clock = 0;
  int arm = 0;
  int wait = 0;
};
Calls calls;

}  // namespace

// They stand before the C library's own for the whole program.
extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  ++calls.clock;
  return static_cast<int>(::syscall(SYS_clock_gettime, clock, time));
}

int recvmmsg(int socket, mmsghdr* messages, unsigned count, int flags, timespec* timeout) {
  ++calls.receive;
  return static_cast<int>(::syscall(SYS_recvmmsg, socket, messages, count, flags, timeout));
}

int epoll_ctl(int epoll, int operation, int descriptor, epoll_event* event) noexcept {
  ++calls.arm;
  return static_cast<int>(::syscall(SYS_epoll_ctl, epoll, operation, descriptor, event));
}

int epoll_wait(int epoll, epoll_event* events, int count, int timeout) {
  ++calls.wait;
  return static_cast<int>(::syscall(SYS_epoll_pwait, epoll, events, count, timeout, nullptr, 0));
}

}  // extern "C"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class ReceiveCostTest : public support::LinkFixture {};

TEST_F(ReceiveCostTest, ABurstCostsAFewSystemCallsPerBatch) {
  constexpr std::uint32_t kFrames = 5000;
  BusSettings settings;
  settings.heartbeat = Duration::zero();
  Bus bus(context.get_executor(), make_socketcan_link(context.get_executor(), "vcan0"), settings);
  std::uint32_t received = 0;
  const Subscription subscription = bus.subscribe(0x185, [&](const Received&) { ++received; });
  bus.start();
  ASSERT_TRUE(run_until([&] { return bus.state().up(); }));
  context.poll();

  support::OtherSocket other("vcan0");
  for (std::uint32_t i = 0; i < kFrames; ++i) {
    other.send_number(i);
  }
  calls = {};
  context.poll();
  EXPECT_EQ(received, kFrames);
  // Ten batches, and a turn of the loop to find that nothing is left.
  EXPECT_LE(calls.receive, 10);
  EXPECT_GE(calls.receive, 1) << "not counted";
  EXPECT_LE(calls.clock, 2 * calls.receive + 4);
  EXPECT_LE(calls.wait, calls.receive + 2);
  EXPECT_LE(calls.arm, 2);
}

}  // namespace
}  // namespace canopen
