#include "daemon/terminal.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <string>

namespace gateway {

void outlive_job_control() {
  std::signal(SIGTTIN, SIG_IGN);
  std::signal(SIGTTOU, SIG_IGN);
}

bool may_read_terminal(int descriptor) {
  const pid_t foreground = ::tcgetpgrp(descriptor);
  // No terminal, or not the one of this session, where there is no foreground to be in.
  return foreground < 0 || foreground == ::getpgrp();
}

int reopen(int descriptor, int access) {
  struct stat status{};
  if (::fstat(descriptor, &status) != 0 || !(S_ISCHR(status.st_mode) || S_ISFIFO(status.st_mode))) {
    return -1;
  }
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  return ::open(path.c_str(), access | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
}

}  // namespace gateway
