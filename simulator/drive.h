#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>

#include "canopen/frame.h"
#include "simulator/alarm.h"
#include "simulator/emergency.h"
#include "simulator/error_control.h"
#include "simulator/heartbeat_consumer.h"
#include "simulator/misbehave.h"
#include "simulator/model.h"
#include "simulator/motor.h"
#include "simulator/network.h"
#include "simulator/nmt_state.h"
#include "simulator/object_dictionary.h"
#include "simulator/options.h"
#include "simulator/pdos.h"
#include "simulator/record.h"
#include "simulator/sdo_server.h"

namespace simulator {

/// The simulator's own u16 in every drive: written with a fault code the drive trips, with 0 its faults are reset at
/// the drive.
inline constexpr Address kTroubleObject{0xBF00, 0};

/// One simulated drive on a Network: a CANopen slave with a motor. Without power until power_on().
/// One loop, one thread. The network outlives it.
class Drive final : public Station {
 public:
  Drive(std::unique_ptr<Model> model, std::uint8_t node, Network& network, const DriveOptions& options);
  ~Drive();
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  void power_on();
  void power_off();
  /// Off and, after `pause`, on again.
  void reboot(canopen::Duration pause = std::chrono::milliseconds(500));
  [[nodiscard]] bool powered() const noexcept { return state_ != NmtState::off; }

  /// A fault of the drive's own table; it trips. Nothing happens without power.
  void fault(std::uint16_t code);
  void warning(std::uint16_t code);
  /// Faults and warnings are reset at the drive itself.
  void clear_faults();
  /// Changes state of its own accord, as a drive in trouble does. Stopped, pre-operational or operational.
  void go(NmtState state);

  [[nodiscard]] std::uint8_t node() const noexcept { return node_; }
  [[nodiscard]] std::string_view kind() const { return model_->kind(); }
  [[nodiscard]] NmtState state() const noexcept { return state_; }
  [[nodiscard]] Misbehaviour& misbehaviour() noexcept { return misbehaviour_; }
  [[nodiscard]] const Record& record() const noexcept { return record_; }
  [[nodiscard]] Record& record() noexcept { return record_; }
  [[nodiscard]] Motor& motor() noexcept { return motor_; }
  [[nodiscard]] ObjectDictionary& dictionary() noexcept { return dictionary_; }
  [[nodiscard]] Emergency& emergency() noexcept { return emergency_; }
  [[nodiscard]] Pdos& pdos() noexcept { return pdos_; }
  [[nodiscard]] const Model& model() const noexcept { return *model_; }

  /// One line of `name=value` pairs: power, nmt, motor, faults and counters.
  [[nodiscard]] std::string describe();

  void on_frame(const canopen::Frame& frame) override;
  void on_bus_up() override;
  void on_tick(canopen::Duration passed) override;

 private:
  void restart();
  void boot();
  void stop_communication();
  void start_communication();
  void restore_communication_settings();
  void enter(NmtState state);
  void define_communication_objects();
  void define_trouble_object();
  [[nodiscard]] PdoContext pdo_context();
  [[nodiscard]] ErrorControl::Actions error_control_actions();
  void on_nmt(const canopen::Frame& frame);
  void on_sync(const canopen::Frame& frame);
  void on_sdo_request(const canopen::Frame& frame);
  [[nodiscard]] Abort refuse_sdo_write(Address address) const;
  void answer_due();
  void send_boot_up();
  void on_heartbeat_lost(std::uint8_t sub, std::uint8_t node);
  void on_connection_lost(ConnectionLoss loss);
  void on_rpdo_length_error(std::uint8_t number, bool too_long);
  [[nodiscard]] bool hears() const noexcept;
  void send_status(std::uint8_t status);
  void send_emergency(std::uint32_t cob_id, const EmergencyMessage& message);
  bool send(const canopen::Frame& frame);

  static constexpr std::uint32_t kSyncCobId = 0x80;  ///< 0x1005

  static constexpr std::uint8_t kStateBits = 0x7F;  ///< Of a guarding answer; bit 7 toggles.
  static constexpr std::size_t kLateAnswers = 64;
  static constexpr std::uint8_t kCommunicationError = 0x11;  ///< error register: generic and communication

  struct LateAnswer {
    canopen::TimePoint due;
    canopen::Frame frame;
  };

  std::unique_ptr<Model> model_;
  std::uint8_t node_;
  Network& network_;
  DriveOptions options_;
  NmtState state_ = NmtState::off;
  bool boot_up_waiting_ = false;  ///< The bus was down when the boot-up frame should have left.

  Misbehaviour misbehaviour_;
  Record record_;
  Motor motor_;
  ObjectDictionary dictionary_;
  Emergency emergency_;
  SdoServer sdo_;
  Pdos pdos_;
  ErrorControl error_control_;
  HeartbeatConsumer heartbeat_consumer_;
  std::uint8_t error_behaviour_ = 0;  ///< 0x1029:01: 0 pre-operational, 1 no change, 2 stopped
  std::uint32_t sync_cob_id_ = kSyncCobId;
  std::uint8_t sync_overflow_ = 0;  ///< 0x1019: 0 SYNC without counter

  std::deque<LateAnswer> late_answers_;
  Alarm answer_alarm_;
  Alarm boot_alarm_;
};

/// The kinds make_drive() knows, for help and error texts: "veichi-ac300, veichi-ac310, ...".
[[nodiscard]] std::string drive_kinds();

/// Nothing when the kind is unknown or the node is not 1..127; why_no_drive() has the text.
[[nodiscard]] std::unique_ptr<Drive> make_drive(std::string_view kind, std::uint8_t node, Network& network,
                                                const DriveOptions& options = {});
/// Empty when make_drive() would make one.
[[nodiscard]] std::string why_no_drive(std::string_view kind, std::uint8_t node);

}  // namespace simulator
