// Part of every unit test. While time is moved by hand a timer is due at once or never, but Asio would arm a timerfd
// for each step of time and each new timer all the same: 10 µs of kernel a time, nine tenths of what all tests took.
// Where the kernel has no timerfd Asio looks after its timers by itself in every turn of the loop.

#include <sys/timerfd.h>

#include <cerrno>

extern "C" int timerfd_create(clockid_t /*clock*/, int /*flags*/) noexcept {
  errno = ENOSYS;
  return -1;
}
