#include "canopen/bus/socketcan/receive_batch.h"

#include <algorithm>
#include <cstring>
#include <ctime>
#include <span>
#include <utility>

namespace canopen::socketcan {
namespace {

WallTime wall_of(const timespec& stamp) {
  return WallTime(std::chrono::seconds(stamp.tv_sec) + std::chrono::nanoseconds(stamp.tv_nsec));
}

}  // namespace

ReceiveBatch::ReceiveBatch() {
  for (std::size_t i = 0; i < kCapacity; ++i) {
    vectors_[i] = {&frames_[i], sizeof frames_[i]};
    messages_[i].msg_hdr.msg_iov = &vectors_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_control = controls_[i].bytes.data();
  }
}

int ReceiveBatch::read(int socket) {
  // The kernel has shortened these to what it wrote last time. The others are not touched: usually few frames wait.
  for (mmsghdr& message : std::span(messages_).first(std::exchange(used_, 0))) {
    message.msg_hdr.msg_controllen = sizeof(Control::bytes);
  }
  const int count = ::recvmmsg(socket, messages_.data(), kCapacity, MSG_DONTWAIT, nullptr);
  used_ = static_cast<std::size_t>(std::max(count, 0));
  return count;
}

ReceiveBatch::Item ReceiveBatch::item(std::size_t index) const {
  // CMSG_NXTHDR wants it writable, and writes nothing.
  msghdr header = messages_[index].msg_hdr;
  Item item;
  item.frame = from_kernel(frames_[index]);
  item.echo = (header.msg_flags & MSG_CONFIRM) != 0;
  bool stamped = false;
  for (cmsghdr* control = CMSG_FIRSTHDR(&header); control != nullptr; control = CMSG_NXTHDR(&header, control)) {
    if (control->cmsg_level != SOL_SOCKET) {
      continue;
    }
    if (control->cmsg_type == SCM_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(control), sizeof stamp);
      item.wall = wall_of(stamp);
      stamped = true;
    } else if (control->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t count = 0;
      std::memcpy(&count, CMSG_DATA(control), sizeof count);
      item.dropped = count;
    }
  }
  if (!stamped) {
    item.wall = wall_now();
  }
  return item;
}

Frame from_kernel(const can_frame& frame) noexcept {
  Frame result;
  result.error = (frame.can_id & CAN_ERR_FLAG) != 0;
  result.remote = (frame.can_id & CAN_RTR_FLAG) != 0;
  result.extended = (frame.can_id & CAN_EFF_FLAG) != 0;
  result.id = frame.can_id & (result.extended || result.error ? CAN_EFF_MASK : CAN_SFF_MASK);
  result.size = std::min<std::uint8_t>(frame.can_dlc, CAN_MAX_DLEN);
  std::copy_n(std::begin(frame.data), result.size, result.data.begin());
  return result;
}

can_frame to_kernel(const Frame& frame) noexcept {
  can_frame result{};
  result.can_id = frame.id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  if (frame.extended) {
    result.can_id |= CAN_EFF_FLAG;
  }
  if (frame.remote) {
    result.can_id |= CAN_RTR_FLAG;
  }
  result.can_dlc = std::min<std::uint8_t>(frame.size, CAN_MAX_DLEN);
  if (!frame.remote) {
    std::copy_n(frame.data.begin(), result.can_dlc, std::begin(result.data));
  }
  return result;
}

}  // namespace canopen::socketcan
