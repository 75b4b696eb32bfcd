#include "daemon/output.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "daemon/terminal.h"

namespace gateway {
namespace {

constexpr std::chrono::milliseconds kForEver(-1);

std::error_code wait_until_writable(int descriptor, std::chrono::milliseconds patience) {
  pollfd waiting{descriptor, POLLOUT, 0};
  const int ready = ::poll(&waiting, 1, static_cast<int>(patience.count()));
  if (ready == 0) {
    return std::make_error_code(std::errc::timed_out);
  }
  // Whatever else poll has to tell, the next write tells better.
  return ready > 0 || errno == EINTR ? std::error_code() : std::error_code(errno, std::generic_category());
}

// What was not written is left in `text`.
std::error_code write_some(int descriptor, std::string_view& text, std::chrono::milliseconds patience) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written >= 0) {
      text.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno == EAGAIN) {
      if (const std::error_code stalled = wait_until_writable(descriptor, patience)) {
        return stalled;
      }
    } else if (errno != EINTR) {
      return {errno, std::generic_category()};
    }
  }
  return {};
}

}  // namespace

std::error_code write_text(int descriptor, std::string_view text, std::chrono::milliseconds patience) {
  return write_some(descriptor, text, patience);
}

void print(std::string_view text) {
  if (const std::error_code failure = write_text(STDOUT_FILENO, text, kForEver)) {
    throw std::system_error(failure, "standard output");
  }
}

LiveOutput::LiveOutput(int descriptor, std::function<void()> on_failure)
    : own_(reopen(descriptor, O_WRONLY)),
      descriptor_(own_ >= 0 ? own_ : descriptor),
      on_failure_(std::move(on_failure)) {}

LiveOutput::~LiveOutput() {
  if (own_ >= 0) {
    ::close(own_);
  }
}

void LiveOutput::write(std::string_view text) {
  if (failure_) {
    return;
  }
  if (waiting_.size() + text.size() <= kMostWaiting) {
    waiting_ += text;
  }
  write_on(std::chrono::milliseconds(0));
}

void LiveOutput::write_on(std::chrono::milliseconds patience) {
  std::string_view left = waiting_;
  const std::error_code outcome = write_some(descriptor_, left, patience);
  waiting_.erase(0, waiting_.size() - left.size());
  if (outcome && outcome != std::errc::timed_out) {
    failure_ = outcome;
    on_failure_();
  }
}

void LiveOutput::require_written() {
  if (!failure_) {
    write_on(kPatience);
  }
  if (failure_) {
    throw std::system_error(failure_, "standard output");
  }
}

}  // namespace gateway
