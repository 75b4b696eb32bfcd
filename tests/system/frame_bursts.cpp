// frame_bursts INTERFACE RATE SECONDS: that many frames a second of COB-ID 0x7A0, which nobody uses, eighty at a time
// by one system call. Afterwards how many there were.

#include <linux/can.h>
#include <net/if.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

namespace {

constexpr unsigned kNobody = 0x7A0;
constexpr std::size_t kAtOnce = 80;

}  // namespace

int main(int argc, char** argv) {
  const int bus = socket(PF_CAN, SOCK_RAW, CAN_RAW);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = argc == 4 ? static_cast<int>(if_nametoindex(argv[1])) : 0;
  if (address.can_ifindex == 0 || bind(bus, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    std::fputs("usage: frame_bursts INTERFACE RATE SECONDS, where the interface is\n", stderr);
    return 2;
  }
  setsockopt(bus, SOL_CAN_BASE + CAN_RAW, 1, nullptr, 0);  // CAN_RAW_FILTER: it hears nobody
  std::array<can_frame, kAtOnce> frames{};
  std::array<iovec, kAtOnce> places{};
  std::array<mmsghdr, kAtOnce> messages{};
  for (std::size_t i = 0; i < kAtOnce; ++i) {
    frames.at(i).can_id = kNobody;
    frames.at(i).can_dlc = 8;
    places.at(i) = {&frames.at(i), sizeof(can_frame)};
    messages.at(i).msg_hdr.msg_iov = &places.at(i);
    messages.at(i).msg_hdr.msg_iovlen = 1;
  }
  const double rate = std::atof(argv[2]);
  const auto begin = std::chrono::steady_clock::now();
  unsigned long sent = 0;
  while (static_cast<double>(sent) < rate * std::atof(argv[3])) {
    std::this_thread::sleep_until(begin + std::chrono::duration<double>(static_cast<double>(sent) / rate));
    const int taken = sendmmsg(bus, messages.data(), kAtOnce, 0);
    if (taken <= 0) {
      std::perror("frame_bursts: frames could not be sent");
      return 1;
    }
    sent += static_cast<unsigned long>(taken);
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::printf("%lu %.0f\n", sent, static_cast<double>(sent) / took.count());
}
