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

  /// `transmit_class`: sdo, command or stop. `channel` outlives the exchange. `late_possible`: see SdoTransfer.
  SdoExchange(const Channel& channel, SdoTransfer transfer, TransmitClass transmit_class, TimePoint deadline,
              bool late_possible);
  ~SdoExchange() = default;
  SdoExchange(const SdoExchange&) = delete;
  SdoExchange& operator=(const SdoExchange&) = delete;

  /// Sends the first request and returns when all is over. Of requests that follow each other without an answer each
  /// waits for the departure of the one before, so that all else that is to leave gets in between; and with more than
  /// an answer to come a request waits for the budget of the bus, half of the time of an answer at most.
  boost::asio::awaitable<void> run();
  /// Takes a frame of the node; where it asks for more, the next request is sent.
  SdoTransfer::Step on_answer(std::span<const std::uint8_t> answer);
  /// Ends it, for a reason from outside.
  void interrupt(Error why);
  /// Where the first request has not left it never will. An upload in segments or blocks ends, with the next frame of
  /// the node at the latest.
  void withdraw();
  /// The same, and its answer is not awaited after `until`.
  void hurry(TimePoint until);
  /// Another client asked the node: whose answers come now nobody can tell, so where ours may have left it ends at
  /// once. Returns whether it did.
  bool disturb();

  [[nodiscard]] const SdoTransfer& transfer() const noexcept { return transfer_; }
  [[nodiscard]] bool is_command() const noexcept { return transmit_class_ == TransmitClass::command; }
  [[nodiscard]] bool is_stop() const noexcept { return transmit_class_ == TransmitClass::stop; }
  /// The newest request has not left.
  [[nodiscard]] bool waits_to_leave() const { return request_.waiting(); }
  /// Why it failed; Error::not_sent where the first request never left.
  [[nodiscard]] const std::optional<Error>& error() const noexcept { return error_; }
  /// The answer came that ends it, or the last one before it was withdrawn.
  [[nodiscard]] bool answered() const noexcept { return !waits_; }
  /// A request has left, or may have, and its answer did not come.
  [[nodiscard]] bool unanswered() const noexcept { return waits_ && !never_left(); }
  [[nodiscard]] bool timed_out() const noexcept { return error_ && error_->kind == ErrorKind::timeout; }
  /// It ended because it was withdrawn, or to be over soon.
  [[nodiscard]] bool gave_way() const noexcept {
    return cut_short_ || given_up_ || (withdrawn_ && timed_out() && !unanswered());
  }
  /// It ended because another client asked the node.
  [[nodiscard]] bool disturbed() const noexcept { return disturbed_; }

 private:
  void send();
  void send_in_turn();
  void await_answer(TimePoint from);
  void give_up();
  void on_departure(Departure how);
  void end(std::optional<Error> why);
  [[nodiscard]] bool is_sent_once() const noexcept { return is_command() || is_stop(); }
  [[nodiscard]] Error no_answer() const;
  [[nodiscard]] bool never_left() const noexcept {
    return departure_ == Departure::withdrawn || departure_ == Departure::offline;
  }

  const Channel& channel_;
  SdoTransfer transfer_;
  TransmitClass transmit_class_;
  TimePoint due_ = kNever;      ///< The next answer must be here by then; not known before the request has left.
  TimePoint deadline_;          ///< `due_` never passes it,
  TimePoint limit_ = kNever;    ///< nor that.
  TimePoint next_at_ = kNever;  ///< The next request is to be sent then.
  bool late_possible_;
  Event ended_;
  Ticket request_;
  std::optional<Departure> departure_;  ///< Of the newest request.
  TimePoint left_at_{};                 ///< The same, where it left or may have.
  bool waits_ = true;                   ///< The newest request has no answer yet.
  bool withdrawn_ = false;
  bool given_up_ = false;
  bool cut_short_ = false;
  bool disturbed_ = false;
  bool over_ = false;
  std::optional<Error> error_;
};

}  // namespace canopen
