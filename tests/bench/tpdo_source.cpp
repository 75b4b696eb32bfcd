// tpdo_source INTERFACE DRIVES RATE SECONDS: what that many Goodrive600 send that all change all the time. RATE TPDO2 a
// second, the nodes in turn, each numbered by node from 1 on: the number is its output frequency, set frequency and DC
// bus voltage. Heartbeats between. Afterwards one line a TPDO: NODE NUMBER, and when it was sent (s since 1970).

#include <linux/can.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <iterator>
#include <random>
#include <thread>
#include <vector>

namespace {

using std::chrono::duration;
using std::chrono::system_clock;

constexpr unsigned kTpdo2 = 0x280;
constexpr unsigned kHeartbeat = 0x700;
constexpr std::uint8_t kOperational = 5;
constexpr std::uint8_t kStopped = 3;  // status word of the drive: ready, the motor at rest
constexpr std::uint8_t kReady = 1;
constexpr duration<double> kHeartbeatPeriod(0.5);
constexpr int kHeartbeatsMore = 3;

struct Sent {
  unsigned node;
  unsigned number;
  system_clock::time_point at;
};

void send(int bus, unsigned id, std::initializer_list<std::uint8_t> data) {
  can_frame frame{};
  frame.can_id = id;
  frame.can_dlc = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), std::begin(frame.data));
  if (write(bus, &frame, sizeof frame) != static_cast<ssize_t>(sizeof frame)) {
    std::perror("tpdo_source: a frame could not be sent");
    std::exit(1);
  }
}

void send_tpdo2(int bus, unsigned node, unsigned number) {
  const auto low = static_cast<std::uint8_t>(number);
  const auto high = static_cast<std::uint8_t>(number >> 8U);
  send(bus, kTpdo2 + node, {kStopped, kReady, low, high, low, high, low, high});
}

void send_heartbeats(int bus, unsigned drives) {
  for (unsigned node = 1; node <= drives; ++node) {
    send(bus, kHeartbeat + node, {kOperational});
  }
}

std::vector<Sent> run(int bus, unsigned drives, double rate, double seconds) {
  std::vector<Sent> sent;
  sent.reserve(static_cast<std::size_t>(rate * seconds));
  // At random within its turn, so that what follows is in step with no timer of the kernel.
  std::minstd_rand random(drives);
  std::uniform_real_distribution<double> within(0, 1);
  const auto begin = system_clock::now();
  duration<double> next_heartbeat(0);
  for (unsigned i = 0; i < sent.capacity(); ++i) {
    const duration<double> due((i + within(random)) / rate);
    std::this_thread::sleep_until(begin + due);
    if (due >= next_heartbeat) {
      send_heartbeats(bus, drives);
      next_heartbeat += kHeartbeatPeriod;
    }
    const unsigned node = 1 + i % drives;
    const unsigned number = 1 + i / drives;
    sent.push_back({node, number, system_clock::now()});
    send_tpdo2(bus, node, number);
  }
  for (int i = 0; i < kHeartbeatsMore; ++i) {
    send_heartbeats(bus, drives);
    std::this_thread::sleep_for(kHeartbeatPeriod);
  }
  return sent;
}

}  // namespace

int main(int argc, char** argv) {
  const int bus = socket(PF_CAN, SOCK_RAW, CAN_RAW);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = argc == 5 ? static_cast<int>(if_nametoindex(argv[1])) : 0;
  if (address.can_ifindex == 0 || bind(bus, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    std::fputs("usage: tpdo_source INTERFACE DRIVES RATE SECONDS, where the interface is\n", stderr);
    return 2;
  }
  setsockopt(bus, SOL_CAN_BASE + CAN_RAW, 1, nullptr, 0);  // CAN_RAW_FILTER: it hears nobody
  for (const Sent& each : run(bus, static_cast<unsigned>(std::atoi(argv[2])), std::atof(argv[3]), std::atof(argv[4]))) {
    std::printf("%u %u %.6f\n", each.node, each.number, duration<double>(each.at.time_since_epoch()).count());
  }
}
