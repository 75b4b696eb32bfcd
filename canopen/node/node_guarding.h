#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <optional>

#include "canopen/bus/cyclic_producer.h"
#include "canopen/bus/ticket.h"
#include "canopen/clock.h"
#include "canopen/frame.h"

namespace canopen {

class Bus;

/// What an answer to guarding is worth.
enum class GuardAnswer : std::uint8_t {
  good,
  wrong_toggle,       ///< To be handled as if it was not received (CiA 301 §7.2.8.2.2.1).
  wrong_toggle_again  ///< Likewise, and no good one came since the last such answer.
};

/// Node guarding as its master (CiA 301 §7.2.8.2.2): requests to one node, and the toggle bit of its answers, which
/// alternates from 0 on after a boot-up. Whether a request does harm others find out first (life_guarding.h). Requests
/// that have begun go on until somebody stops them: a node whose life guarding they have started would trip.
class NodeGuarding {
 public:
  /// `bus` outlives it. `period` above zero, where start() is ever called.
  NodeGuarding(const boost::asio::any_io_executor& executor, Bus& bus, std::uint8_t node, Duration period);

  /// A single request. Its answer is not judged.
  void ask();
  /// A request each period, the first at once. Where they go already, nothing changes.
  void start();
  /// What has not left is withdrawn. Which toggle bit comes next is still known.
  void stop();
  [[nodiscard]] bool running() const noexcept { return running_; }

  /// The node's communication begins anew: its next answer has the toggle bit 0.
  void begin_anew() noexcept { expected_ = false; }
  /// An answer may have been lost: the next one may have either.
  void forget() noexcept { expected_.reset(); }
  /// An answer came.
  GuardAnswer take(bool toggle) noexcept;
  /// Since the start something answered, were it with a wrong toggle bit.
  [[nodiscard]] bool answered() const noexcept { return answered_; }
  /// Since the start two answers in a row were good: what answers is guarding indeed, and not a bit that stands still.
  [[nodiscard]] bool alternates() const noexcept { return good_in_a_row_ >= 2; }

 private:
  void send(const Frame& request);

  Bus& bus_;
  Frame request_;
  bool running_ = false;
  std::optional<bool> expected_;
  unsigned good_in_a_row_ = 0;
  bool answered_ = false;
  bool wrong_ = false;  ///< The last answer, were it before the start.
  CyclicProducer producer_;
  Ticket ticket_;
};

}  // namespace canopen
