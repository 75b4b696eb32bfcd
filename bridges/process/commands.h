#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridges/process/command.h"
#include "bridges/process/command_queue.h"
#include "bridges/process/command_sender.h"
#include "bridges/process/image.h"
#include "bridges/process/write_plan.h"
#include "bridges/process/writer.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/nmt.h"
#include "canopen/node/node_events.h"
#include "canopen/object.h"
#include "config/model.h"

namespace canopen {
class RemoteNode;
}

namespace process {

/// The arbiter: every command to one drive, whatever its way, passes here. In this order: writer allowed, access, type,
/// range, drive reachable; then in order of arrival by RPDO or SDO; then the outcome, at the latest when the drive's
/// deadline has passed since the arrival. Nothing is stored for later and nothing sent twice.
class Commands {
 public:
  /// Told of signals, in order of position.
  using Told = std::function<void(std::span<const SignalId>)>;

  /// `model`, `node` and `image` outlive it. `confirmed` is told which signals have a new commanded value, `unknown`
  /// of which nobody knows any more what was commanded last.
  Commands(boost::asio::any_io_executor executor, const config::Drive& model, canopen::RemoteNode& node, Image& image,
           Told confirmed, Told unknown);

  boost::asio::awaitable<Outcome> write(Origin origin, std::vector<FieldWrite> fields, StillStands still_stands = {});
  boost::asio::awaitable<Outcome> nmt(Origin origin, canopen::NmtCommand command);
  boost::asio::awaitable<canopen::Result<canopen::Raw>> sdo_read(canopen::ObjectAddress object, canopen::DataType type);
  boost::asio::awaitable<Outcome> sdo_write(Origin origin, canopen::ObjectValue value);

  void on_status(const canopen::NodeStatus& status);
  void on_boot_up();
  /// A fault came or went, or a quick stop that nobody commanded began: what was commanded before is neither to be sent
  /// again by a set-point nor repeated.
  void on_fault();
  /// The motor came to a stop, or nobody can tell any more whether it turns: likewise.
  void on_standstill();

  /// Answers what is pending, and all that comes from now on, with `offline`.
  void close() { queue_.close(); }
  boost::asio::awaitable<void> until_idle() { return queue_.until_empty(); }

 private:
  /// What was true when a command arrived.
  struct Arrival {
    canopen::TimePoint deadline;
    std::uint32_t session = 0;
    std::uint32_t knowledge = 0;
  };

  [[nodiscard]] Arrival arrive() const;
  [[nodiscard]] std::optional<canopen::Error> refuse_unreachable() const;
  /// `running`: nothing where nobody can tell.
  [[nodiscard]] std::optional<canopen::Error> refuse_nmt(canopen::NmtCommand command,
                                                         std::optional<bool> running) const;
  /// The same for a command that has its turn. A drive that was left alone is asked whether its motor runs.
  boost::asio::awaitable<std::optional<canopen::Error>> refuse_nmt_now(canopen::NmtCommand command);
  [[nodiscard]] canopen::Error error(canopen::ErrorKind kind, std::string detail) const;
  [[nodiscard]] canopen::Error no_turn() const;
  [[nodiscard]] std::optional<canopen::Error> refuse_new_session(Arrival arrival) const;

  /// Nothing where the command has its turn and the drive is still the one it was meant for.
  boost::asio::awaitable<std::optional<canopen::Error>> await_turn(const CommandQueue::Ticket& ticket, Arrival arrival);
  boost::asio::awaitable<Outcome> carry_out(std::vector<Field> fields, Arrival arrival, StillStands still_stands);
  /// A step is about to be sent: what it was made from may not stand any more.
  [[nodiscard]] std::optional<canopen::Error> refuse_outlived(const StillStands& still_stands);
  /// What a step has left behind.
  void tell(const WriteStep& step, const Outcome& outcome, const Arrival& arrival);
  [[nodiscard]] static std::vector<SignalId> signals_of(const WriteStep& step);
  /// Whether the motor runs; nothing where nobody can tell.
  [[nodiscard]] std::optional<bool> running() const;

  const config::Drive& model_;
  canopen::RemoteNode& node_;
  Image& image_;
  Told confirmed_;
  Told unknown_;
  CommandQueue queue_;
  CommandSender sender_;
  bool live_ = false;
  std::uint32_t session_ = 0;  ///< Grows when the drive reboots, is lost or leaves operational.
};

}  // namespace process
