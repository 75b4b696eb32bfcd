#include "daemon/doctor/interface.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <net/if_arp.h>
#include <sys/socket.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "canopen/bus/socketcan/descriptor.h"
#include "canopen/bus/socketcan/driver.h"
#include "canopen/bus/socketcan/interface_query.h"
#include "canopen/bus/socketcan/interface_state.h"

namespace gateway::doctor {
namespace {

namespace fs = std::filesystem;
using canopen::socketcan::Interface;

// The kernel's number of its kind (linux/if_arp.h).
bool is_can_interface(const fs::path& directory) {
  std::ifstream file(directory / "type");
  int type = 0;
  return static_cast<bool>(file >> type) && type == ARPHRD_CAN;
}

std::vector<std::string> can_interfaces() {
  std::vector<std::string> names;
  std::error_code failed;
  for (fs::directory_iterator each("/sys/class/net", failed), end; !failed && each != end; each.increment(failed)) {
    if (is_can_interface(each->path())) {
      names.push_back(each->path().filename().string());
    }
  }
  std::ranges::sort(names);
  return names;
}

std::string set_up(const config::Bus& bus, bool has_controller) {
  if (!has_controller) {  // vcan and its like have no bit rate to set
    return fmt::format("`ip link set {} up`", bus.interface);
  }
  return fmt::format("`ip link set {} up type can bitrate {} restart-ms 100`; for good see systemd/ in the sources",
                     bus.interface, bus.bitrate ? std::to_string(*bus.bitrate) : "BITRATE");
}

Line missing(const config::Bus& bus, const std::vector<std::string>& others) {
  const std::string subject = "bus " + bus.name;
  if (others.empty()) {
    return {Verdict::error, subject,
            fmt::format("there is no interface {}, and no other of CAN on this machine", bus.interface),
            "plug the adapter in; `dmesg` and `lsusb` show whether the kernel knows it"};
  }
  return {Verdict::error, subject,
          fmt::format("there is no interface {}; those of CAN are {}", bus.interface, fmt::join(others, ", ")),
          "plug the adapter in, or name the right one as `interface`"};
}

Line judge_state(const config::Bus& bus, const Interface& interface) {
  const std::string subject = "bus " + bus.name;
  const canopen::BusState state = canopen::socketcan::state_of(interface, {});
  const std::string told = fmt::format("{} is {}", bus.interface, canopen::describe(state.condition));
  switch (state.condition) {
    case canopen::BusCondition::error_active:
      return {Verdict::ok, subject, told};
    case canopen::BusCondition::down:
      return {Verdict::error, subject,
              interface.administratively_up ? told + ": it is switched on, but has no carrier" : told,
              set_up(bus, interface.condition.has_value())};
    case canopen::BusCondition::bus_off:
      return {Verdict::error, subject, told,
              "look at bit rate, wiring, termination; then `ip link set " + bus.interface + " type can restart`"};
    case canopen::BusCondition::warning:
    case canopen::BusCondition::passive:
      break;
  }
  return {
      Verdict::warning, subject,
      fmt::format("{}, transmit errors {}, receive errors {}", told, state.transmit_errors, state.receive_errors),
      "is anybody else on the bus, at the same bit rate; 120 ohms at both ends and nowhere else; CAN_H and CAN_L not "
      "exchanged?"};
}

void judge_timing(Lines& lines, const config::Bus& bus, const Interface& interface) {
  const std::string subject = "bus " + bus.name;
  if (!interface.timing) {
    if (!bus.bitrate) {
      lines.push_back(
          {Verdict::warning, subject,
           bus.interface + " tells no bit rate, and `bitrate` is not given: no load is known, SDO goes slowly",
           "give `bitrate` in [[bus]]"});
    }
    return;
  }
  lines.push_back({Verdict::ok, subject, canopen::describe(*interface.timing)});
  for (const std::string& doubt : canopen::doubts_about(*interface.timing, bus.bitrate)) {
    // Its words: what is wrong, a semicolon, what to do.
    const std::size_t parted = doubt.rfind("; ");
    lines.push_back({Verdict::warning, subject, doubt.substr(0, parted),
                     parted == std::string::npos ? set_up(bus, true) : doubt.substr(parted + 2)});
  }
}

}  // namespace

InterfaceFacts look_at_interface(const std::string& name) {
  InterfaceFacts facts{.others = can_interfaces()};
  canopen::socketcan::InterfaceQuery query;
  canopen::socketcan::InterfaceQuery::Answer answer = query.ask(name);
  facts.error = answer.error;
  facts.interface = answer.interface;
  facts.is_can = is_can_interface(fs::path("/sys/class/net") / name);
  const canopen::socketcan::Descriptor any(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  facts.driver = canopen::socketcan::driver_of(any.get(), name);
  return facts;
}

Lines judge(const config::Bus& bus, const InterfaceFacts& facts) {
  const std::string subject = "bus " + bus.name;
  if (facts.error) {
    return {{Verdict::error, subject, "the kernel does not tell of " + bus.interface + ": " + facts.error.message(),
             "look at what confines this process (AF_NETLINK)"}};
  }
  if (!facts.interface) {
    return {missing(bus, facts.others)};
  }
  if (!facts.is_can) {
    return {{Verdict::error, subject, bus.interface + " is no CAN interface", "name the right one as `interface`"}};
  }
  Lines lines{judge_state(bus, *facts.interface)};
  judge_timing(lines, bus, *facts.interface);
  const std::string notice = canopen::socketcan::no_departure_notice(bus.echo, facts.interface->echoes, facts.driver);
  if (!notice.empty()) {
    lines.push_back({Verdict::warning, subject, bus.interface + ": " + notice,
                     "where that matters take an adapter whose driver tells it (gs_usb, kvaser_usb, PCI cards)"});
  }
  return lines;
}

}  // namespace gateway::doctor
