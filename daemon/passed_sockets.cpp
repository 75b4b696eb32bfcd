#include "daemon/passed_sockets.h"

#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <cstring>
#include <numeric>

namespace gateway {

std::vector<int> passed_sockets() {
  // The variables are left: nobody is started by us, and the log's thread may be reading the environment.
  const int count = sd_listen_fds(0);
  if (count < 0) {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): the text of this thread's call
    spdlog::warn("sockets of the service manager cannot be taken: {}", std::strerror(-count));
    return {};
  }
  std::vector<int> descriptors(static_cast<std::size_t>(count));
  std::iota(descriptors.begin(), descriptors.end(), SD_LISTEN_FDS_START);
  return descriptors;
}

}  // namespace gateway
