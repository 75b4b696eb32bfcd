#include "tests/bench/broker.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

namespace bench {

Broker::Broker(std::uint16_t port) : port_(port), config_(fmt::format("/tmp/gateway-bench-{}.conf", getpid())) {
  std::ofstream(config_) << "listener " << port
                         << " 127.0.0.1\nallow_anonymous true\nmax_queued_messages 0\nlog_type none\n";
  process_ = fork();
  if (process_ == 0) {
    execlp("mosquitto", "mosquitto", "-c", config_.c_str(), nullptr);
    _exit(127);
  }
}

Broker::~Broker() {
  kill(process_, SIGTERM);
  waitpid(process_, nullptr, 0);
  unlink(config_.c_str());
}

std::string Broker::uri() const {
  return fmt::format("tcp://127.0.0.1:{}", port_);
}

}  // namespace bench
