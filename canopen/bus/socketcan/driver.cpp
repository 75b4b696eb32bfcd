#include "canopen/bus/socketcan/driver.h"

#include <linux/ethtool.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>

namespace canopen::socketcan {
namespace {

// They set IFF_ECHO, but give the echo back when the USB transfer to the adapter is complete (can_get_echo_skb() in the
// callback of the write URB, drivers/net/can/usb/ of Linux), not when the adapter tells that the frame was
// acknowledged.
constexpr std::array<std::string_view, 4> kEchoAtTransfer{"ems_usb", "mcba_usb", "peak_usb", "usb_8dev"};

std::string why_no_departure(EchoProves configured, bool echoes, std::string_view driver) {
  switch (configured) {
    case EchoProves::departure:
      return {};
    case EchoProves::adapter:
      return "so it is configured";
    case EchoProves::by_driver:
      break;
  }
  if (!echoes) {
    return "no IFF_ECHO";
  }
  if (std::find(kEchoAtTransfer.begin(), kEchoAtTransfer.end(), driver) != kEchoAtTransfer.end()) {
    return std::string(driver) + " confirms what its adapter has taken";
  }
  return {};
}

}  // namespace

std::string driver_of(int socket, std::string_view interface) {
  ethtool_drvinfo info{};
  info.cmd = ETHTOOL_GDRVINFO;
  ifreq request{};
  if (interface.size() >= sizeof request.ifr_name) {
    return {};
  }
  std::copy(interface.begin(), interface.end(), std::begin(request.ifr_name));
  request.ifr_data = reinterpret_cast<char*>(&info);
  if (::ioctl(socket, SIOCETHTOOL, &request) != 0) {
    return {};
  }
  return {std::begin(info.driver), ::strnlen(info.driver, sizeof info.driver)};
}

std::string no_departure_notice(EchoProves configured, bool echoes, std::string_view driver) {
  const std::string why = why_no_departure(configured, echoes, driver);
  return why.empty() ? why
                     : "it is not told when a frame has left (" + why +
                           "): a command counts as sent when the kernel or the adapter has taken it";
}

}  // namespace canopen::socketcan
