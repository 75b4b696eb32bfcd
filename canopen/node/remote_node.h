#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <memory>
#include <span>
#include <vector>

#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/node/node_events.h"
#include "canopen/node/node_settings.h"
#include "canopen/still_stands.h"

namespace canopen {

class Bus;

/// A drive as the master sees it: one supervising coroutine that boots it or takes it over, serves it until it is lost
/// or rebooted, and begins again. One dead drive never delays another.
class RemoteNode {
 public:
  /// `bus` and `events` outlive the node.
  RemoteNode(boost::asio::any_io_executor executor, Bus& bus, NodeSettings settings, NodeEvents& events);
  ~RemoteNode();
  RemoteNode(const RemoteNode&) = delete;
  RemoteNode& operator=(const RemoteNode&) = delete;

  void start();
  /// Ends the supervision and fails what is pending with `offline`. Sends nothing.
  boost::asio::awaitable<void> stop();

  [[nodiscard]] const NodeSettings& settings() const noexcept;
  [[nodiscard]] const NodeStatus& status() const noexcept;
  /// What its bus received before this moment has been told. Behind the clock after a stall of the process, until what
  /// waited was read: nothing is overdue that may still come.
  [[nodiscard]] TimePoint heard_until() const;
  /// The drive confirmed (or was given) the transmission type and timers of this TPDO, so `period` can be relied on.
  [[nodiscard]] bool tpdo_verified(std::uint16_t number) const noexcept;

  /// The end is near: a node that is not in service is neither configured nor started any more. Before stop().
  void close();

  /// SDO upload with retries. Refused as offline while the node does not answer SDOs at all, or is stopped.
  /// `due`: when it was to be done; of all that waits for its turn on a busy bus the earliest is next.
  boost::asio::awaitable<Result<Raw>> read(ObjectAddress object, DataType type, TimePoint due = Clock::now());
  /// SDO download of a command: sent once, withdrawn when not begun by `deadline`, outcome unknown when begun and
  /// unconfirmed by then. One not begun when the drive leaves operational is withdrawn, too: `offline`;
  /// one that was made from what does not stand any more: `incomplete`.
  boost::asio::awaitable<Result<void>> write(ObjectAddress object, DataType type, Raw raw, TimePoint deadline,
                                             StillStands still_stands = {});
  /// Departure of an NMT command. Only `start` ends the refusal to start a drive that left operational; where the drive
  /// was not configured since, it is booted first, and the departure is that of the boot's NMT start. A boot that was
  /// begun goes on after the deadline, so the outcome is unknown then.
  boost::asio::awaitable<Result<void>> command(NmtCommand command, TimePoint deadline);

  /// The RPDO that maps `object` (used as commanded); 0: none.
  [[nodiscard]] std::uint16_t rpdo_of(ObjectAddress object) const noexcept;
  /// RPDO `number` can be sent: every field is in `fields`, known from earlier confirmed commands, or declared unused.
  [[nodiscard]] bool rpdo_complete(std::uint16_t number, std::span<const ObjectValue> fields) const noexcept;
  /// Sends the RPDO with `fields` over what is known; confirmed by its departure. A field whose outcome is unknown
  /// counts as not commanded afterwards. `incomplete` where a field is missing.
  boost::asio::awaitable<Result<void>> send_rpdo(std::uint16_t number, std::vector<ObjectValue> fields,
                                                 TimePoint deadline);
  /// A confirmed SDO write: its field counts as commanded with this value.
  void note_commanded(const ObjectValue& value);
  /// A command of `object` goes by SDO now: an RPDO that is repeated must not undo it meanwhile.
  void hold_repetition(ObjectAddress object);
  /// Its field counts as not commanded (momentary value sent, or outcome unknown).
  void forget_commanded(ObjectAddress object);
  /// Nothing counts as commanded (fault, standstill, a command timeout that ends RPDOs). Boot-up, loss and leaving
  /// operational do it by themselves. `keep_repeating`: an RPDO that the drive supervises (event timer > 0) goes on
  /// being repeated unchanged, for a drive that came to a stop and would trip otherwise.
  void void_rpdos(bool keep_repeating = false);

 private:
  class Supervisor;
  std::unique_ptr<Supervisor> supervisor_;
};

}  // namespace canopen
