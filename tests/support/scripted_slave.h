#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "canopen/bus/link.h"
#include "canopen/bus/virtual_link.h"
#include "canopen/clock.h"
#include "canopen/frame.h"
#include "canopen/object.h"

namespace support {

/// A node that does what a test tells it: answers SDOs from a map of bytes, misbehaves per object, keeps an NMT state
/// and a heartbeat, and remembers every frame the master sent. It knows nothing of drives.
class ScriptedSlave final : private canopen::LinkEvents {
 public:
  using Bytes = std::vector<std::uint8_t>;
  /// Sees an SDO request first; the frames it returns are the answer, nothing means: answer as usual.
  using Script = std::function<std::optional<std::vector<Bytes>>(const Bytes& request)>;

  ScriptedSlave(boost::asio::any_io_executor executor, canopen::VirtualBus& bus, std::uint8_t node);
  ~ScriptedSlave();
  ScriptedSlave(const ScriptedSlave&) = delete;
  ScriptedSlave& operator=(const ScriptedSlave&) = delete;

  // The dictionary.
  void set(canopen::ObjectAddress object, canopen::DataType type, canopen::Raw raw);
  void set_bytes(canopen::ObjectAddress object, Bytes bytes) { objects_[object] = std::move(bytes); }
  void remove(canopen::ObjectAddress object) { objects_.erase(object); }
  [[nodiscard]] std::uint64_t value(canopen::ObjectAddress object) const;

  // Misbehaviour.
  void script(Script script) { script_ = std::move(script); }
  void mute(canopen::ObjectAddress object) { muted_.insert(object); }
  void unmute(canopen::ObjectAddress object) { muted_.erase(object); }
  void mute_sdo(bool mute) { sdo_muted_ = mute; }
  void refuse_write(canopen::ObjectAddress object, std::uint32_t code) { refused_writes_[object] = code; }
  /// Writes are confirmed and change nothing.
  void ignore_write(canopen::ObjectAddress object) { ignored_writes_.insert(object); }
  void delay_answers(canopen::Duration delay) { answer_delay_ = delay; }
  /// Called after each accepted write.
  void on_write(std::function<void(canopen::ObjectAddress)> handler) { on_write_ = std::move(handler); }

  // NMT.
  /// Boot-up message, pre-operational, and `lose` forgotten.
  void boot_up();
  void set_state(std::uint8_t state) { state_ = state; }
  [[nodiscard]] std::uint8_t state() const noexcept { return state_; }
  void ignore_nmt(bool ignore) { nmt_ignored_ = ignore; }
  /// Off the bus: hears and sends nothing.
  void unplug(bool unplugged) { unplugged_ = unplugged; }
  void heartbeat_off(bool off) { heartbeat_off_ = off; }
  void answer_guarding(bool answer) { guarding_ = answer; }
  /// Whether the toggle bit of guarding answers alternates (CiA 301 §7.2.8.2.2.1), or stands still from now on.
  void toggle(bool toggles) { toggles_ = toggles; }

  void send(std::uint32_t cob_id, Bytes bytes);

  // What the master sent.
  [[nodiscard]] const std::vector<canopen::Frame>& heard() const noexcept { return heard_; }
  void forget_heard() { heard_.clear(); }
  [[nodiscard]] std::vector<canopen::Frame> heard_on(std::uint32_t cob_id) const;
  /// SDO downloads begun, of any object but in the order they came.
  [[nodiscard]] std::vector<canopen::ObjectAddress> writes() const;
  [[nodiscard]] std::vector<canopen::ObjectAddress> reads() const;

 private:
  struct Answer {
    canopen::TimePoint at;
    Bytes bytes;
  };

  void on_frames(std::span<const canopen::Received> frames) override;
  void on_echo(const canopen::Received&) override {}
  void on_bus_state(const canopen::BusState&) override {}
  void on_frames_lost(std::uint32_t) override {}

  void on_sdo(const Bytes& request);
  void on_nmt(const canopen::Frame& frame);
  void read_object(canopen::ObjectAddress object);
  void write_object(canopen::ObjectAddress object, Bytes data);
  void on_segment(const Bytes& request);
  void abort(canopen::ObjectAddress object, std::uint32_t code);
  void answer(Bytes bytes);
  void tick();
  void arm();

  canopen::VirtualBus& bus_;
  std::uint8_t node_;
  canopen::Timer timer_;
  std::unique_ptr<canopen::Link> link_;
  std::vector<canopen::Frame> heard_;
  std::map<canopen::ObjectAddress, Bytes> objects_;
  std::set<canopen::ObjectAddress> muted_;
  std::set<canopen::ObjectAddress> ignored_writes_;
  std::map<canopen::ObjectAddress, std::uint32_t> refused_writes_;
  std::function<void(canopen::ObjectAddress)> on_write_;
  Script script_;
  std::vector<Answer> pending_;
  canopen::Duration answer_delay_{};
  canopen::TimePoint next_heartbeat_{};
  canopen::ObjectAddress segmented_{};
  Bytes segments_;
  bool segmented_write_ = false;
  std::size_t segment_offset_ = 0;
  std::uint8_t state_ = 127;
  bool sdo_muted_ = false;
  bool nmt_ignored_ = false;
  bool unplugged_ = false;
  bool heartbeat_off_ = false;
  bool guarding_ = false;
  bool toggles_ = true;
  std::uint8_t toggle_ = 0;
};

}  // namespace support
