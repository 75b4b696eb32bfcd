#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <cerrno>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "canopen/bus/socketcan/socketcan_link.h"
#include "tests/bench/parts.h"
#include "tests/bench/rates.h"
#include "tests/bench/site.h"

namespace bench {
namespace {

constexpr unsigned kBatch = 1000;  // What waits when frames come faster than anybody takes them.
constexpr int kBatchesARound = 20;

/// What a bare loop asks of the kernel.
enum class Receive : std::uint8_t {
  frames,         ///< Nothing but frames.
  with_all_facts  ///< When each came, and how many were lost: what no gateway can do without.
};

/// A raw socket as bare as it gets.
class BareSocket {
 public:
  BareSocket(const std::string& interface, Receive what)
      : descriptor_(socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK, CAN_RAW)), what_(what) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
    if (descriptor_ < 0 || address.can_ifindex == 0 ||
        bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error(interface + ": no such CAN interface; run this on the machine of tests/vcan/run");
    }
    const int size = 8 * 1024 * 1024;
    setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUFFORCE, &size, sizeof size);
    if (what_ == Receive::with_all_facts) {
      const int on = 1;
      setsockopt(descriptor_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
      setsockopt(descriptor_, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
    }
  }
  ~BareSocket() { close(descriptor_); }
  BareSocket(const BareSocket&) = delete;
  BareSocket& operator=(const BareSocket&) = delete;

  void send(const can_frame& frame) const {
    while (write(descriptor_, &frame, sizeof frame) != static_cast<ssize_t>(sizeof frame)) {
      if (errno != EAGAIN && errno != ENOBUFS) {
        throw std::runtime_error("a frame could not be sent");
      }
    }
  }

  /// Reads what is there, 64 at a time.
  unsigned receive() {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      vectors_[i] = {&frames_[i], sizeof frames_[i]};
      messages_[i] = {};
      messages_[i].msg_hdr.msg_iov = &vectors_[i];
      messages_[i].msg_hdr.msg_iovlen = 1;
      if (what_ == Receive::with_all_facts) {
        messages_[i].msg_hdr.msg_control = controls_[i].data();
        messages_[i].msg_hdr.msg_controllen = controls_[i].size();
      }
    }
    const int count = recvmmsg(descriptor_, messages_.data(), static_cast<unsigned>(messages_.size()), 0, nullptr);
    return count < 0 ? 0 : static_cast<unsigned>(count);
  }

 private:
  int descriptor_;
  Receive what_;
  std::array<can_frame, 64> frames_{};
  std::array<std::array<char, 128>, 64> controls_{};
  std::array<iovec, 64> vectors_{};
  std::array<mmsghdr, 64> messages_{};
};

/// The gateway and its simulated drives on a real interface, on loops that are turned by hand, so that only the
/// gateway's own work is measured.
class HandTurnedSite {
 public:
  explicit HandTurnedSite(const std::string& interface)
      : model_(demo_model(free_port(), 0)), gateway_(loop_.get_executor(), model_, [&](const config::Bus&) {
          return canopen::make_socketcan_link(loop_.get_executor(), interface);
        }) {
    const std::size_t network =
        drives_.add_network(canopen::make_socketcan_link(drive_loop_.get_executor(), interface));
    for (const config::Drive& drive : model_.drives) {
      drives_.add_drive(network, drive.profile, drive.node.node);
    }
    gateway_.start();
    drives_.start();
  }
  ~HandTurnedSite() {
    drives_.stop();
    bool stopped = false;
    boost::asio::co_spawn(loop_, gateway_.stop(), [&](const std::exception_ptr&) { stopped = true; });
    while (!stopped) {
      loop_.poll();
    }
  }
  HandTurnedSite(const HandTurnedSite&) = delete;
  HandTurnedSite& operator=(const HandTurnedSite&) = delete;

  void turn() {
    drive_loop_.poll();
    loop_.poll();
  }
  void turn_gateway() { loop_.poll(); }
  [[nodiscard]] bool online() { return gateway_.plant().online() == model_.drives.size(); }
  [[nodiscard]] std::uint64_t received() { return gateway_.plant().bus_statistics(0).frames_received; }
  [[nodiscard]] std::uint32_t lost() { return gateway_.plant().bus_statistics(0).frames_lost; }
  [[nodiscard]] process::Plant& plant() { return gateway_.plant(); }

 private:
  boost::asio::io_context loop_{1};
  boost::asio::io_context drive_loop_{1};
  config::Model model_;
  gateway::SimulatedSite drives_{drive_loop_.get_executor()};
  gateway::Gateway gateway_;
};

class FrameBench {
 public:
  FrameBench(const std::string& interface, Receive ceiling)
      : site_(interface), sender_(interface, Receive::frames), bare_(interface, ceiling) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!site_.online()) {
      if (std::chrono::steady_clock::now() > end) {
        throw std::runtime_error("the simulated drives did not come online");
      }
      site_.turn();
    }
  }

  /// Frames per second of the bare loop; the gateway's half of the same frames is told by gateway(). Of the fastest
  /// batch: what else runs on the machine stops either of them now and then, for longer than a whole batch takes.
  double ceiling() {
    bare_seconds_.clear();
    gateway_seconds_.clear();
    for (int batch = 0; batch < kBatchesARound; ++batch) {
      one_batch();
    }
    return kBatch / *std::min_element(bare_seconds_.begin(), bare_seconds_.end());
  }
  double gateway() const { return kBatch / *std::min_element(gateway_seconds_.begin(), gateway_seconds_.end()); }

  void check() {
    if (site_.lost() != 0) {
      throw std::runtime_error("the gateway lost frames");
    }
    const process::Drive& drive = site_.plant().drive(drive_);
    const auto current = drive.model().find("output_current");
    if (!current || drive.image().raw(static_cast<process::SignalId>(*current)) != last_value_) {
      throw std::runtime_error("the last frame is not in the image");
    }
  }

 private:
  void one_batch() {
    site_.turn();
    while (bare_.receive() > 0) {
    }
    const std::uint64_t before = site_.received();
    send_batch();
    unsigned got = 0;
    bare_seconds_.push_back(seconds_of([&] {
      while (got < kBatch) {
        got += bare_.receive();
      }
    }));
    gateway_seconds_.push_back(seconds_of([&] {
      while (site_.received() - before < kBatch) {
        site_.turn_gateway();
      }
    }));
    check();
  }

  // TPDO1 of the AC310: status, output current, output frequency, speed.
  void send_batch() {
    const config::Drive& drive = site_.plant().drive(drive_).model();
    for (unsigned i = 0; i < kBatch; ++i) {
      can_frame frame{};
      frame.can_id = 0x180U + drive.node.node;
      frame.can_dlc = 8;
      last_value_ = ++counter_ & 0xFFFU;
      frame.data[2] = static_cast<std::uint8_t>(last_value_);
      frame.data[3] = static_cast<std::uint8_t>(last_value_ >> 8U);
      sender_.send(frame);
    }
  }

  HandTurnedSite site_;
  BareSocket sender_;
  BareSocket bare_;
  std::size_t drive_ = 1;
  std::vector<double> bare_seconds_;  ///< Of each batch of the round.
  std::vector<double> gateway_seconds_;
  unsigned counter_ = 0;
  std::uint64_t last_value_ = 0;
};

}  // namespace

void frames(const std::string& interface) {
  const auto measure = [&](std::string what, Receive ceiling) {
    FrameBench bench(interface, ceiling);
    print(compare(std::move(what), "frames/s", 10, [&] { return bench.ceiling(); }, [&] { return bench.gateway(); }));
  };
  measure("frames to image, of bare recvmmsg", Receive::frames);
  measure("frames to image, of recvmmsg with times", Receive::with_all_facts);
}

}  // namespace bench
