#include "daemon/doctor/presence.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>

#include "canopen/bus/socketcan/descriptor.h"
#include "daemon/control/exchange.h"

namespace gateway::doctor {
namespace {

std::error_code current_error() {
  return {errno, std::generic_category()};
}

// Without waiting: one that hangs may have a full queue of those who want to connect (then EAGAIN, unix(7)).
GatewayFacts knock(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) {
    return {.error = std::make_error_code(std::errc::filename_too_long)};
  }
  std::ranges::copy(path, std::begin(address.sun_path));
  const canopen::socketcan::Descriptor to(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (to.get() < 0 || ::connect(to.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return {.error = current_error()};
  }
  ucred who{};
  socklen_t size = sizeof(who);
  const bool known = ::getsockopt(to.get(), SOL_SOCKET, SO_PEERCRED, &who, &size) == 0;
  return {.process = known ? who.pid : 0};
}

}  // namespace

GatewayFacts ask_gateway(const std::filesystem::path& socket, std::chrono::milliseconds patience) {
  if (socket.empty()) {
    return {};
  }
  GatewayFacts facts = knock(socket.string());
  if (!facts.error) {
    const control::Exchanged answer = control::exchange(socket, R"({"id":1,"op":"status"})", patience);
    facts.silence = answer.problem.substr(0, answer.problem.find(';'));
  }
  return facts;
}

Presence presence_of(const std::filesystem::path& socket, const GatewayFacts& facts) noexcept {
  if (socket.empty()) {
    return Presence::unknown;
  }
  if (facts.error == std::errc::no_such_file_or_directory || facts.error == std::errc::connection_refused) {
    return Presence::absent;
  }
  return facts.error || !facts.silence.empty() ? Presence::unknown : Presence::runs;
}

Line judge(const std::filesystem::path& socket, const GatewayFacts& facts) {
  constexpr const char* kLook = "`systemctl status canopen-gateway`, `journalctl -u canopen-gateway`";
  if (socket.empty()) {
    return {Verdict::warning, "gateway", "`control` is empty: whether it runs is not known",
            "without a control socket `status`, `set` and `stop` of this program do not work either"};
  }
  switch (presence_of(socket, facts)) {
    case Presence::runs:
      return {Verdict::ok, "gateway", "it runs and answers; `canopen-gateway status` shows its drives"};
    case Presence::absent:
      return {Verdict::warning, "gateway", fmt::format("it does not run: nobody listens at {}", socket.string()),
              kLook};
    case Presence::unknown:
      break;
  }
  if (!facts.error) {
    return {Verdict::warning, "gateway", "whether it works is not known: " + facts.silence, kLook};
  }
  return {Verdict::warning, "gateway",
          fmt::format("whether it runs is not known: {}: {}", socket.string(), facts.error.message()),
          fmt::format("run this as root; {}", kLook)};
}

}  // namespace gateway::doctor
