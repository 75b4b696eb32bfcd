#pragma once

#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/capability.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "canopen/bus/socketcan/socketcan_link.h"

// What the tests of the SocketCAN link share. They run as root against a kernel with SocketCAN: tests/vcan/run.

namespace support {

inline void shell(const std::string& command) {
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

/// Takes CAP_NET_ADMIN from this process for a while: the daemon runs without it.
class WithoutNetAdmin {
 public:
  WithoutNetAdmin() {
    EXPECT_EQ(::syscall(SYS_capget, &header_, before_.data()), 0);
    auto reduced = before_;
    reduced[CAP_TO_INDEX(CAP_NET_ADMIN)].effective &= ~CAP_TO_MASK(CAP_NET_ADMIN);
    EXPECT_EQ(::syscall(SYS_capset, &header_, reduced.data()), 0);
  }
  ~WithoutNetAdmin() { EXPECT_EQ(::syscall(SYS_capset, &header_, before_.data()), 0); }
  WithoutNetAdmin(const WithoutNetAdmin&) = delete;
  WithoutNetAdmin& operator=(const WithoutNetAdmin&) = delete;

 private:
  __user_cap_header_struct header_{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> before_{};
};

/// Another program on the same interface.
class OtherSocket {
 public:
  explicit OtherSocket(const std::string& interface) : socket_(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~OtherSocket() { ::close(socket_); }
  OtherSocket(const OtherSocket&) = delete;
  OtherSocket& operator=(const OtherSocket&) = delete;

  void send(std::uint32_t kernel_id, const std::vector<std::uint8_t>& bytes = {}) {
    can_frame frame{};
    frame.can_id = kernel_id;
    frame.can_dlc = static_cast<std::uint8_t>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), std::begin(frame.data));
    ASSERT_EQ(::write(socket_, &frame, sizeof frame), static_cast<ssize_t>(sizeof frame));
  }
  void send_number(std::uint32_t number) {
    send(0x185, {static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8),
                 static_cast<std::uint8_t>(number >> 16)});
  }
  /// An error frame as a driver makes it.
  void send_error(std::uint32_t classes, std::uint8_t status, std::uint8_t transmit, std::uint8_t receive) {
    send(CAN_ERR_FLAG | classes, {0, status, 0, 0, 0, 0, transmit, receive});
  }

 private:
  int socket_;
};

inline std::uint32_t number_in(const canopen::Frame& frame) {
  return frame.data[0] + (std::uint32_t{frame.data[1]} << 8) + (std::uint32_t{frame.data[2]} << 16);
}

class Recorder final : public canopen::LinkEvents {
 public:
  void on_frames(std::span<const canopen::Received> frames) override {
    largest_batch = std::max(largest_batch, frames.size());
    received.insert(received.end(), frames.begin(), frames.end());
    if (when_received) {
      when_received();
    }
  }
  void on_echo(const canopen::Received& sent) override { echoes.push_back(sent.frame); }
  void on_bus_state(const canopen::BusState& state) override { states.push_back(state); }
  void on_frames_lost(std::uint32_t count) override { lost += count; }
  void on_error_frame(const canopen::Received&, canopen::ErrorSign sign) override { error_signs.push_back(sign); }

  [[nodiscard]] bool is(canopen::BusCondition condition) const {
    return !states.empty() && states.back().condition == condition;
  }

  std::vector<canopen::Received> received;
  std::vector<canopen::Frame> echoes;
  std::vector<canopen::BusState> states;
  std::vector<canopen::ErrorSign> error_signs;
  std::uint32_t lost = 0;
  std::size_t largest_batch = 0;
  std::function<void()> when_received;
};

inline canopen::Frame frame(std::uint32_t id, std::uint8_t content = 0) {
  const std::array bytes{content};
  return canopen::make_frame(id, bytes);
}

class LinkFixture : public ::testing::Test {
 protected:
  void SetUp() override {
    shell("ip link show vcan0 >/dev/null 2>&1 || ip link add vcan0 type vcan");
    shell("ip link set vcan0 txqueuelen 1000 up");
  }
  void TearDown() override { link.reset(); }

  void open(const std::string& interface) {
    link = canopen::make_socketcan_link(context.get_executor(), interface,
                                        [this](const std::string& text) { notices.push_back(text); });
    link->open(events);
  }
  void open_active() {
    open("vcan0");
    ASSERT_TRUE(run_until([&] { return events.is(canopen::BusCondition::error_active); }));
  }
  /// Runs the loop until `done`; false after five seconds.
  [[nodiscard]] bool run_until(const std::function<bool()>& done) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (!done()) {
      if (std::chrono::steady_clock::now() > end) {
        return false;
      }
      context.run_one_for(std::chrono::milliseconds(100));
    }
    return true;
  }
  void run_for(canopen::Duration time) { context.run_for(time); }

  boost::asio::io_context context{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{context.get_executor()};
  Recorder events;
  std::vector<std::string> notices;
  std::unique_ptr<canopen::Link> link;
};

}  // namespace support
