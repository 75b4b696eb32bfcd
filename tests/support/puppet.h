#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "canopen/bus/link.h"
#include "canopen/bus/virtual_link.h"
#include "canopen/nmt.h"
#include "canopen/object.h"

namespace support {

/// A CANopen node on strings: it answers SDO from its dictionary and follows NMT; all else it does when a test says so.
class Puppet final : public canopen::LinkEvents {
 public:
  Puppet(canopen::VirtualBus& bus, std::uint8_t node);

  void boot_up();
  void heartbeat();
  void tpdo(std::uint16_t number, std::span<const std::uint8_t> bytes);
  void emergency(std::span<const std::uint8_t> bytes);

  struct Entry {
    std::uint32_t value = 0;
    std::uint8_t size = 0;
  };
  std::map<canopen::ObjectAddress, Entry> dictionary;
  std::map<canopen::ObjectAddress, std::uint32_t> refuse_writes;  ///< Abort codes.
  bool deaf_to_nmt = false;                                       ///< Follows no NMT command.
  bool mute = false;                                              ///< Answers no SDO and beats no heart.

  std::vector<canopen::ObjectValue> written;  ///< By SDO; the type is not told.
  std::vector<canopen::Frame> rpdos;
  std::vector<std::uint8_t> nmt_commands;

  void on_frames(std::span<const canopen::Received> frames) override;
  void on_echo(const canopen::Received& sent) override;
  void on_bus_state(const canopen::BusState& state) override;
  void on_frames_lost(std::uint32_t count) override;

 private:
  void send(std::uint32_t cob_id, std::span<const std::uint8_t> bytes);
  void on_nmt(const canopen::Frame& frame);
  void on_sdo(const canopen::Frame& frame);

  std::uint8_t node_;
  canopen::NmtState state_ = canopen::NmtState::pre_operational;
  std::unique_ptr<canopen::Link> link_;
};

}  // namespace support
