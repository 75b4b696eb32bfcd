#include "tests/vcan/slcan_adapter.h"

#include <net/if.h>
#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace support {
namespace {

constexpr int kSlcanDiscipline = 17;  // N_SLCAN of <linux/tty.h>

void require(bool fulfilled, const char* what) {
  if (!fulfilled) {
    throw std::system_error(errno, std::generic_category(), what);
  }
}

}  // namespace

SlcanTerminal::SlcanTerminal() {
  require(::openpty(&device_, &terminal_, nullptr, nullptr, nullptr) == 0, "openpty");
  termios raw{};
  require(::tcgetattr(terminal_, &raw) == 0, "tcgetattr");
  ::cfmakeraw(&raw);
  require(::tcsetattr(terminal_, TCSANOW, &raw) == 0, "tcsetattr");
  require(::ioctl(terminal_, TIOCSETD, &kSlcanDiscipline) == 0, "line discipline slcan");
  ifreq request{};
  require(::ioctl(terminal_, SIOCGIFNAME, &request) == 0, "name of the slcan interface");
  interface_ = static_cast<const char*>(request.ifr_name);
}

SlcanTerminal::~SlcanTerminal() {
  ::close(terminal_);
  ::close(device_);
}

void SlcanTerminal::say(const std::string& line) const {
  const std::string text = line + '\r';
  require(::write(device_, text.data(), text.size()) == static_cast<ssize_t>(text.size()), "write to slcan");
}

SlcanAdapter::SlcanAdapter() : listener_([this](const std::stop_token& stop) { listen(stop); }) {}

SlcanAdapter::~SlcanAdapter() {
  listener_.request_stop();
  listener_.join();
}

std::string SlcanAdapter::heard() {
  const std::lock_guard lock(mutex_);
  return heard_;
}

void SlcanAdapter::listen(const std::stop_token& stop) {
  constexpr int kLookForStop = 20;  // ms
  std::array<char, 256> buffer{};
  while (!stop.stop_requested()) {
    pollfd readable{terminal_.device(), POLLIN, 0};
    if (::poll(&readable, 1, kLookForStop) <= 0) {
      continue;
    }
    const ssize_t size = ::read(terminal_.device(), buffer.data(), buffer.size());
    if (size <= 0) {
      return;
    }
    const std::lock_guard lock(mutex_);
    heard_.append(buffer.data(), static_cast<std::size_t>(size));
  }
}

}  // namespace support
