#include "daemon/doctor/machine.h"

#include <fmt/format.h>
#include <linux/can.h>
#include <sys/socket.h>
#include <sys/timex.h>

#include <cerrno>
#include <fstream>

#include "canopen/bus/socketcan/descriptor.h"
#include "canopen/bus/socketcan/raw_socket.h"
#include "daemon/program_health.h"

namespace gateway::doctor {
namespace {

Line judge_can(const std::error_code& error) {
  if (!error) {
    return {Verdict::ok, "SocketCAN", "this kernel has it"};
  }
  if (error == std::errc::address_family_not_supported || error == std::errc::protocol_not_supported) {
    return {
        Verdict::error, "SocketCAN", "this kernel has no CAN sockets",
        "`modprobe can-raw`; where there is no such module take a kernel with CONFIG_CAN (Debian's has it; those of "
        "many containers and virtual servers do not)"};
  }
  return {Verdict::error, "SocketCAN", "no CAN socket can be opened: " + error.message(),
          "look at what confines this process: seccomp, RestrictAddressFamilies, the rules of a container"};
}

Line judge_buffer(const std::optional<std::uint64_t>& rmem_max) {
  constexpr std::uint64_t kWanted = canopen::socketcan::kWantedReceiveBuffer;
  if (!rmem_max) {
    return {Verdict::warning, "receive buffer", "net.core.rmem_max cannot be read",
            fmt::format("see to it that it is at least {}", kWanted)};
  }
  if (*rmem_max < kWanted) {
    return {Verdict::warning, "receive buffer",
            fmt::format("net.core.rmem_max is {}: frames may be lost in bursts", *rmem_max),
            fmt::format("`sysctl --system` where the package is installed, which has a file for it; else `sysctl -w "
                        "net.core.rmem_max={}`, and for good a line with that in /etc/sysctl.d",
                        kWanted)};
  }
  return {Verdict::ok, "receive buffer", fmt::format("net.core.rmem_max is {}", *rmem_max)};
}

Line judge_clock(const MachineFacts& facts) {
  if (is_unset(facts.now)) {
    return {Verdict::warning, "clock", "nobody has set it since the machine started",
            "give the machine a time server (`timedatectl set-ntp true`): alarms and the journal carry its time"};
  }
  if (facts.clock_synchronised == false) {
    return {Verdict::warning, "clock", "it is set, but no time server keeps it right",
            "`timedatectl timesync-status` tells why; times of alarms drift apart from those of others"};
  }
  return {Verdict::ok, "clock", facts.clock_synchronised ? "set, and kept right" : "set"};
}

}  // namespace

MachineFacts look_at_machine() {
  MachineFacts facts;
  const canopen::socketcan::Descriptor can(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW));
  if (can.get() < 0) {
    facts.can = std::error_code(errno, std::generic_category());
  }
  std::ifstream file("/proc/sys/net/core/rmem_max");
  if (std::uint64_t bytes = 0; file >> bytes) {
    facts.rmem_max = bytes;
  }
  facts.now = canopen::wall_now();
  timex time{};
  if (const int state = ::adjtimex(&time); state >= 0) {
    facts.clock_synchronised = state != TIME_ERROR && (static_cast<unsigned>(time.status) & STA_UNSYNC) == 0;
  }
  return facts;
}

Lines judge(const MachineFacts& facts) {
  return {judge_can(facts.can), judge_buffer(facts.rmem_max), judge_clock(facts)};
}

}  // namespace gateway::doctor
