#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canopen/clock.h"
#include "canopen/nmt.h"
#include "canopen/node/boot_result.h"
#include "canopen/node/doubled_id.h"
#include "canopen/node/emcy.h"
#include "canopen/node/emcy_setup.h"
#include "canopen/object.h"

namespace canopen {

/// Why a node with letter J is neither configured nor started.
enum class HeldBack : std::uint8_t {
  no,                ///< It is not held back.
  left_operational,  ///< It left operational by itself.
  found_stopped      ///< Somebody stopped it before we came.
};

/// What is known of a node right now.
struct NodeStatus {
  bool online = false;                  ///< Error control alive, and booted or taken over, and the bus up.
  bool configured = false;              ///< Boot or takeover finished since the last boot-up or loss.
  NmtState nmt = NmtState::unknown;     ///< As it was heard.
  std::optional<NmtState> commanded{};  ///< Stopped or pre-operational by a command of ours, not heard since.
  BootResult boot_result = BootResult::not_booted;
  std::string boot_text;  ///< Why boot_result is a letter, or why no more is known. Empty: nothing is wrong.
  HeldBack held_back = HeldBack::no;        ///< Of meaning beside `not_configured` only.
  std::optional<TimePoint> last_heartbeat;  ///< Heartbeat, boot-up or guarding answer.
  bool lost = false;  ///< Error control ran out, or the drive never appeared within heartbeat_timeout.
  std::uint32_t boot_ups = 0;
  std::uint32_t emergencies = 0;
  std::uint32_t heartbeat_losses = 0;
  std::uint32_t last_abort = 0;  ///< Of the newest SDO abort, 0: none.
  /// Whether another node has the same node id. With proof it takes no commands but stops.
  Doubled doubled = Doubled::no;
  std::string doubled_text;  ///< By what that is known.

  /// What it is by now as far as anybody knows.
  [[nodiscard]] NmtState nmt_now() const noexcept { return commanded.value_or(nmt); }
  void set_nmt(NmtState state) noexcept {
    nmt = state;
    commanded.reset();
  }
  friend bool operator==(const NodeStatus&, const NodeStatus&) = default;
};

/// How a node came online.
enum class Arrival : std::uint8_t {
  booted,     ///< Configured and started by us after its boot-up or return.
  taken_over  ///< Found operational as wanted; nothing was written or commanded.
};

/// What a remote node tells the process image. Called from the loop; receivers never call back into the node from
/// inside but through posted work, except RemoteNode::withdraw_command() and repetition_changed().
class NodeEvents {
 public:
  /// Any field of the status changed (heartbeat times alone do not count).
  virtual void on_status(const NodeStatus& status) = 0;
  /// A boot-up message: every value and everything commanded is void.
  virtual void on_boot_up() = 0;
  virtual void on_arrival(Arrival arrival) = 0;
  /// Values in mapping order, dummies included as 0.
  virtual void on_tpdo(std::uint16_t number, std::span<const Raw> values, TimePoint at, WallTime wall) = 0;
  /// A TPDO of another length than its mapping. A shorter one is not decoded; of a longer one the first bytes count,
  /// and on_tpdo() follows.
  virtual void on_tpdo_length(std::uint16_t number, std::size_t expected, std::size_t received) = 0;
  /// NMT start left it as it was: an error may keep it from operational.
  virtual void on_start_ignored() {}
  virtual void on_emcy(const Emcy& emcy, TimePoint at, WallTime wall) = 0;
  /// Where its emergencies go, as it was found or made when it was configured or taken over, shortly before
  /// on_arrival().
  virtual void on_emcy_checked(const EmcyVerdict& /*verdict*/) {}
  /// Frames of this bus were lost before we read them: TPDO values are suspect until refreshed.
  virtual void on_frames_lost() = 0;
  /// What an RPDO that the node supervises is to be repeated with now, one value for each commanded field; nothing: it
  /// is not repeated.
  virtual std::optional<std::vector<ObjectValue>> repetition(std::uint16_t /*rpdo*/) { return std::nullopt; }
  /// Something that a person should know and nothing acts upon: for the log.
  virtual void on_remark(const std::string& /*text*/) {}

 protected:
  ~NodeEvents() = default;
};

}  // namespace canopen
