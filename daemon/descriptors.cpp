#include "daemon/descriptors.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <iostream>
#include <system_error>

namespace gateway {

void open_missing_descriptors() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    if (::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) {
      continue;
    }
    // The lowest free number is this one: those below are open by now.
    if (::open("/dev/null", O_RDWR) != descriptor) {
      throw std::system_error(errno, std::generic_category(), "/dev/null");
    }
  }
}

bool is_journal(int descriptor) {
  const char* const stream = std::getenv("JOURNAL_STREAM");  // NOLINT(concurrency-mt-unsafe): nobody writes to it
  struct stat status{};
  if (stream == nullptr || ::fstat(descriptor, &status) != 0) {
    return false;
  }
  return std::string_view(stream) == std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
}

std::string with_priority(int descriptor, config::Finding::Level level, std::string_view text) {
  if (!is_journal(descriptor)) {
    return std::string(text);
  }
  const std::string_view priority = level == config::Finding::Level::error ? "<3>" : "<4>";
  std::string out;
  while (!text.empty()) {
    const std::size_t line = text.find('\n') == std::string_view::npos ? text.size() : text.find('\n') + 1;
    out.append(priority).append(text.substr(0, line));
    text.remove_prefix(line);
  }
  return out;
}

void complain(std::string_view error) {
  std::cerr << with_priority(STDERR_FILENO, config::Finding::Level::error, "canopen-gateway: " + std::string(error))
            << '\n';
}

}  // namespace gateway
