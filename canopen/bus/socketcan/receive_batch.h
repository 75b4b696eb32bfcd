#pragma once

#include <linux/can.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "canopen/clock.h"
#include "canopen/frame.h"

namespace canopen::socketcan {

/// One call of recvmmsg: many frames for one system call and one look at the clock.
class ReceiveBatch {
 public:
  /// Of a burst, half a millisecond of work. What else is to be done waits that long, at most.
  static constexpr std::size_t kCapacity = 512;

  struct Item {
    Frame frame;
    WallTime wall;      ///< The kernel's stamp; now, where it gave none.
    bool echo = false;  ///< MSG_CONFIRM: our own frame came back.
    /// The kernel's count of frames dropped on this socket so far; told once there are any (SO_RXQ_OVFL).
    std::optional<std::uint32_t> dropped;
  };

  ReceiveBatch();

  /// Reads what is there, at most kCapacity frames. Returns the number read, or -1 with errno.
  int read(int socket);
  [[nodiscard]] Item item(std::size_t index) const;

 private:
  // For the stamp and the drop count, aligned as the kernel writes them.
  struct alignas(cmsghdr) Control {
    std::array<std::uint8_t, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))> bytes;
  };

  std::array<can_frame, kCapacity> frames_{};
  std::array<Control, kCapacity> controls_{};
  std::array<iovec, kCapacity> vectors_{};
  std::array<mmsghdr, kCapacity> messages_{};
  std::size_t used_ = kCapacity;  ///< Of the messages, since they were last made ready.
};

/// Between the kernel's layout and ours.
[[nodiscard]] Frame from_kernel(const can_frame& frame) noexcept;
[[nodiscard]] can_frame to_kernel(const Frame& frame) noexcept;

}  // namespace canopen::socketcan
