#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <optional>
#include <span>

#include "canopen/bus/bus.h"
#include "canopen/bus/ticket.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/event.h"
#include "canopen/sdo/transfer.h"

namespace canopen {

/// A request to a node's SDO server (default channel, COB-ID 0x600 + node id).
[[nodiscard]] Frame sdo_request_frame(std::uint8_t node, const SdoFrame& request) noexcept;

/// One try of a transfer on the bus: it owns the request that is on its way, and the time of the answer counts from the
/// departure of the request. Lives in the coroutine that awaits it.
class SdoExchange {
 public:
  struct Channel {
    boost::asio::any_io_executor executor;
    Bus& bus;
    std::uint8_t node;
    SdoSettings settings;
  };

  /// `transmit_class`: sdo or command. `channel` outlives the exchange. `late_possible`: see SdoTransfer.
  SdoExchange(const Channel& channel, SdoTransfer transfer, TransmitClass transmit_class, TimePoint deadline,
              bool late_possible);
  ~SdoExchange() = default;
  SdoExchange(const SdoExchange&) = delete;
  SdoExchange& operator=(const SdoExchange&) = delete;

  /// Sends the first request and returns when all is over.
  boost::asio::awaitable<void> run();
  /// Takes a frame of the node; where it asks for more, the next request is sent.
  SdoTransfer::Step on_answer(std::span<const std::uint8_t> answer);
  /// Ends it, for a reason from outside.
  void interrupt(Error why);
  /// Where the first request has not left it never will. An upload in segments ends, with its next answer at the
  /// latest.
  void withdraw();

  [[nodiscard]] const SdoTransfer& transfer() const noexcept { return transfer_; }
  [[nodiscard]] bool is_command() const noexcept { return transmit_class_ == TransmitClass::command; }
  /// Why it failed; Error::not_sent where the first request never left.
  [[nodiscard]] const std::optional<Error>& error() const noexcept { return error_; }
  /// The answer came that ends it, or the last one before it was withdrawn.
  [[nodiscard]] bool answered() const noexcept { return !waits_; }
  /// A request has left, or may have, and its answer did not come.
  [[nodiscard]] bool unanswered() const noexcept { return waits_ && !never_left(); }
  [[nodiscard]] bool timed_out() const noexcept { return error_ && error_->kind == ErrorKind::timeout; }
  /// It ended because it was withdrawn.
  [[nodiscard]] bool gave_way() const noexcept { return withdrawn_ && timed_out() && !unanswered(); }

 private:
  void send();
  void on_departure(Departure how);
  void end(std::optional<Error> why);
  [[nodiscard]] bool never_left() const noexcept {
    return departure_ == Departure::withdrawn || departure_ == Departure::offline;
  }

  const Channel& channel_;
  SdoTransfer transfer_;
  TransmitClass transmit_class_;
  TimePoint due_ = kNever;  ///< The next answer must be here by then; not known before the request has left.
  TimePoint deadline_;      ///< `due_` never passes it.
  bool late_possible_;
  Event ended_;
  Ticket request_;
  std::optional<Departure> departure_;  ///< Of the newest request.
  bool waits_ = true;                   ///< The newest request has no answer yet.
  bool withdrawn_ = false;
  bool over_ = false;
  std::optional<Error> error_;
};

}  // namespace canopen
