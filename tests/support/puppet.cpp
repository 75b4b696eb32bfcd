#include "tests/support/puppet.h"

#include <algorithm>
#include <array>

namespace support {
namespace {

constexpr std::uint32_t kNoObject = 0x06020000;

std::array<std::uint8_t, 8> answer(std::uint8_t command, const canopen::Frame& request, std::uint32_t value) {
  return {command,
          request.data[1],
          request.data[2],
          request.data[3],
          static_cast<std::uint8_t>(value),
          static_cast<std::uint8_t>(value >> 8),
          static_cast<std::uint8_t>(value >> 16),
          static_cast<std::uint8_t>(value >> 24)};
}

}  // namespace

Puppet::Puppet(canopen::VirtualBus& bus, std::uint8_t node) : node_(node), link_(bus.connect()) {
  link_->open(*this);
}

void Puppet::send(std::uint32_t cob_id, std::span<const std::uint8_t> bytes) {
  (void)link_->send(canopen::make_frame(cob_id, bytes));
}

void Puppet::boot_up() {
  state_ = canopen::NmtState::pre_operational;
  send(0x700U + node_, std::array<std::uint8_t, 1>{0});
}

void Puppet::heartbeat() {
  if (!mute) {
    send(0x700U + node_, std::array<std::uint8_t, 1>{static_cast<std::uint8_t>(state_)});
  }
}

void Puppet::tpdo(std::uint16_t number, std::span<const std::uint8_t> bytes) {
  send(0x080U + 0x100U * number + node_, bytes);
}

void Puppet::emergency(std::span<const std::uint8_t> bytes) {
  send(0x080U + node_, bytes);
}

void Puppet::on_frames(std::span<const canopen::Received> frames) {
  for (const canopen::Received& received : frames) {
    const canopen::Frame& frame = received.frame;
    if (frame.id == 0) {
      on_nmt(frame);
    } else if (frame.id == 0x200U + node_) {
      rpdos.push_back(frame);
    } else if (frame.id == 0x600U + node_ && !mute) {
      on_sdo(frame);
    }
  }
}

void Puppet::on_nmt(const canopen::Frame& frame) {
  if (deaf_to_nmt || (frame.data[1] != node_ && frame.data[1] != 0)) {
    return;
  }
  nmt_commands.push_back(frame.data[0]);
  switch (canopen::NmtCommand{frame.data[0]}) {
    case canopen::NmtCommand::start:
      state_ = canopen::NmtState::operational;
      break;
    case canopen::NmtCommand::stop:
      state_ = canopen::NmtState::stopped;
      break;
    case canopen::NmtCommand::pre_operational:
      state_ = canopen::NmtState::pre_operational;
      break;
    case canopen::NmtCommand::reset_node:
    case canopen::NmtCommand::reset_communication:
      boot_up();
      return;
  }
  heartbeat();
}

void Puppet::on_sdo(const canopen::Frame& frame) {
  const canopen::ObjectAddress object{static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8), frame.data[3]};
  const auto entry = dictionary.find(object);
  if (entry == dictionary.end()) {
    send(0x580U + node_, answer(0x80, frame, kNoObject));
    return;
  }
  const std::uint8_t command = frame.data[0];
  if (command >> 5 == 2) {
    const auto size_bits = static_cast<std::uint8_t>((4 - entry->second.size) << 2);
    send(0x580U + node_, answer(0x43 | size_bits, frame, entry->second.value));
  } else if (command >> 5 == 1) {
    const auto refused = refuse_writes.find(object);
    if (refused != refuse_writes.end()) {
      send(0x580U + node_, answer(0x80, frame, refused->second));
      return;
    }
    std::uint32_t value = 0;
    const unsigned size = 4U - (command >> 2 & 3U);
    for (unsigned i = 0; i < size; ++i) {
      value |= std::uint32_t{frame.data[4 + i]} << (8 * i);
    }
    entry->second.value = value;
    written.push_back({.object = object, .type = canopen::DataType::u32, .raw = value});
    send(0x580U + node_, answer(0x60, frame, 0));
  }
}

void Puppet::on_echo(const canopen::Received&) {}
void Puppet::on_bus_state(const canopen::BusState& /*state*/) {}
void Puppet::on_frames_lost(std::uint32_t /*count*/) {}

}  // namespace support
