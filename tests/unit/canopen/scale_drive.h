#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>

#include "canopen/bus/link.h"
#include "canopen/bus/virtual_link.h"
#include "canopen/nmt.h"
#include "canopen/node/node_settings.h"

namespace canopen {

/// A drive on a bus with a bit rate: three TPDOs of four objects, one RPDO of three. It answers SDO after 2 ms, NMT
/// start by a heartbeat at once, and has its heartbeat and TPDOs as its dictionary says. It has no timer: act() is to
/// be called when next_action() says so.
class ScaleDrive final : public LinkEvents {
 public:
  ScaleDrive(VirtualBus& bus, NodeSettings settings);

  /// Mapping as wanted; transmission types and 0x1017 are not.
  void switch_on();
  /// All of it as wanted, and operational since long ago.
  void run();
  /// Writes to it are confirmed and change nothing.
  void keep(ObjectAddress object) { kept_ = object; }
  /// Its SDO server sleeps until then.
  void sleep_until(TimePoint time) { awake_at_ = time; }
  [[nodiscard]] TimePoint next_action() const noexcept;
  void act();
  [[nodiscard]] NmtState state() const noexcept { return state_; }
  [[nodiscard]] std::uint32_t value(ObjectAddress object) const { return dictionary_.at(object).value; }
  [[nodiscard]] std::size_t requests() const noexcept { return requests_; }
  [[nodiscard]] std::size_t rpdos() const noexcept { return rpdos_; }

  void on_frames(std::span<const Received> frames) override;
  void on_echo(const Received&) override {}
  void on_bus_state(const BusState&) override {}
  void on_frames_lost(std::uint32_t) override {}

 private:
  struct Entry {
    std::uint32_t value = 0;
    std::uint8_t size = 0;
  };
  struct Answer {
    TimePoint at;
    Frame frame;
  };

  void install(const PdoSettings& pdo, std::uint16_t base, bool as_wanted);
  void install(bool as_wanted);
  void on_request(const Frame& frame);
  void on_nmt(NmtCommand command);
  void heartbeat();
  void send(std::uint32_t cob_id, std::span<const std::uint8_t> bytes);
  [[nodiscard]] Duration heartbeat_period() const;
  [[nodiscard]] Duration tpdo_period() const;

  NodeSettings settings_;
  std::unique_ptr<Link> link_;
  bool on_ = false;
  NmtState state_ = NmtState::pre_operational;
  std::map<ObjectAddress, Entry> dictionary_;
  std::optional<ObjectAddress> kept_;
  TimePoint awake_at_{};
  std::deque<Answer> answers_;
  TimePoint next_heartbeat_ = kNever;
  TimePoint next_tpdos_ = kNever;
  std::size_t requests_ = 0;
  std::size_t rpdos_ = 0;
};

}  // namespace canopen
