// slcan_bridge WIRE: a serial CAN adapter (slcan) whose bus is the interface WIRE. Prints the name of the interface
// that it makes, then obeys lines of standard input, each answered by "ok"; at their end the adapter is pulled.
//   say LINE   tells the driver LINE, such as sb255255 (bus-off)
//   hold       nobody acknowledges: what is to be sent stays inside, and nothing is heard
//   off        the bus is off: what is to be sent is dropped, and nothing is heard
//   on         what stayed inside leaves, and all is well again
#include <linux/can.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <system_error>
#include <vector>

#include "tests/vcan/slcan_adapter.h"

namespace {

enum class Mode : std::uint8_t { on, hold, off };

void require(bool fulfilled, const char* what) {
  if (!fulfilled) {
    throw std::system_error(errno, std::generic_category(), what);
  }
}

int open_wire(const char* interface) {
  const int socket = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(interface));
  require(address.can_ifindex != 0 && ::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0,
          "CAN socket");
  return socket;
}

std::string to_text(const can_frame& frame) {
  std::array<char, 8> digits{};
  std::snprintf(digits.data(), digits.size(), "t%03X%u", frame.can_id & CAN_SFF_MASK, unsigned{frame.can_dlc});
  std::string text(digits.data());
  for (std::size_t i = 0; i < frame.can_dlc; ++i) {
    std::snprintf(digits.data(), digits.size(), "%02X", unsigned{frame.data[i]});
    text += digits.data();
  }
  return text;
}

// `t605840...`: three digits of identifier, one of length, the bytes.
can_frame to_frame(const std::string& text) {
  can_frame frame{};
  frame.can_id = static_cast<canid_t>(std::stoul(text.substr(1, 3), nullptr, 16));
  frame.can_dlc = static_cast<std::uint8_t>(std::min(std::stoul(text.substr(4, 1), nullptr, 16), 8UL));
  for (std::size_t i = 0; i < frame.can_dlc; ++i) {
    frame.data[i] = static_cast<std::uint8_t>(std::stoul(text.substr(5 + 2 * i, 2), nullptr, 16));
  }
  return frame;
}

/// Calls `take` with each line of `text` that is complete, and takes it away.
template <typename Take>
void for_each_line(std::string& text, char end, const Take& take) {
  for (std::size_t at = text.find(end); at != std::string::npos; at = text.find(end)) {
    const std::string line = text.substr(0, at);
    text.erase(0, at + 1);
    take(line);
  }
}

/// False at the end.
bool read_more(int descriptor, std::string& text) {
  std::array<char, 512> buffer{};
  const ssize_t size = ::read(descriptor, buffer.data(), buffer.size());
  text.append(buffer.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  return size > 0;
}

class Bridge {
 public:
  explicit Bridge(const char* wire) : wire_(open_wire(wire)) { std::cout << terminal_.interface() << std::endl; }
  ~Bridge() { ::close(wire_); }
  Bridge(const Bridge&) = delete;
  Bridge& operator=(const Bridge&) = delete;

  void run() {
    std::array<pollfd, 3> sources{pollfd{STDIN_FILENO, POLLIN, 0}, pollfd{terminal_.device(), POLLIN, 0},
                                  pollfd{wire_, POLLIN, 0}};
    while (::poll(sources.data(), sources.size(), -1) > 0) {
      if (sources[0].revents != 0 && !read_more(STDIN_FILENO, orders_)) {
        return;
      }
      if (sources[1].revents != 0 && !read_more(terminal_.device(), told_)) {
        return;
      }
      for_each_line(orders_, '\n', [this](const std::string& line) { obey(line); });
      for_each_line(told_, '\r', [this](const std::string& line) { take(line); });
      if (sources[2].revents != 0) {
        hear();
      }
    }
  }

 private:
  void obey(const std::string& order) {
    if (order.starts_with("say ")) {
      terminal_.say(order.substr(4));
    } else if (order == "hold") {
      mode_ = Mode::hold;
    } else if (order == "off") {
      mode_ = Mode::off;
      held_.clear();
    } else if (order == "on") {
      mode_ = Mode::on;
      for (const can_frame& frame : held_) {
        transmit(frame);
      }
      held_.clear();
    } else {
      throw std::runtime_error("unknown order: " + order);
    }
    std::cout << "ok" << std::endl;
  }

  // Of the driver. `O` and `C` open and close the adapter; the bit rate is no concern of a virtual wire.
  void take(const std::string& line) {
    if (line == "O" || line == "C") {
      open_ = line == "O";
      held_.clear();
    } else if (line.starts_with('t') && mode_ != Mode::off) {
      held_.push_back(to_frame(line));
      if (mode_ == Mode::on) {
        transmit(held_.back());
        held_.clear();
      }
    }
  }

  void hear() {
    can_frame frame{};
    require(::read(wire_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame), "read from the wire");
    if (open_ && mode_ == Mode::on && (frame.can_id & ~CAN_SFF_MASK) == 0) {
      terminal_.say(to_text(frame));
    }
  }

  void transmit(const can_frame& frame) const {
    require(::write(wire_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame), "write to the wire");
  }

  support::SlcanTerminal terminal_;
  int wire_;
  Mode mode_ = Mode::on;
  bool open_ = false;
  std::string orders_;
  std::string told_;
  std::vector<can_frame> held_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: slcan_bridge WIRE\n";
    return 2;
  }
  try {
    Bridge(argv[1]).run();
  } catch (const std::exception& error) {
    std::cerr << "slcan_bridge: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
