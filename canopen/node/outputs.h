#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canopen/bus/ticket.h"
#include "canopen/bus/transmit_class.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/event.h"
#include "canopen/frame.h"
#include "canopen/node/node_settings.h"
#include "canopen/node/pdo.h"
#include "canopen/wake_up.h"

namespace canopen {

class Bus;

/// Sends the RPDOs of one node with the values it is given, and repeats those whose reception the node supervises
/// (event timer, CiA 301 §7.5.2.35) three times per event timer. It remembers no value: what a repetition holds it asks
/// for each time, of the one owner of what was commanded.
class Outputs {
 public:
  using Values = std::vector<ObjectValue>;
  /// What RPDO `number` is to be repeated with now, each commanded field of it; nothing: it is not repeated.
  using Image = std::function<std::optional<Values>(std::uint16_t number)>;

  /// `bus` outlives it.
  Outputs(const boost::asio::any_io_executor& executor, Bus& bus, std::uint8_t node, std::span<const PdoSettings> rpdos,
          Image image);

  /// Confirmed by its departure; from then on it is repeated where the image says so. `values` has each commanded field
  /// of it and nothing else, or it is `incomplete`: no field ever carries a value that nobody gave. While it waits, no
  /// repetition of the same RPDO leaves.
  boost::asio::awaitable<Result<void>> send(std::uint16_t number, Values values, TransmitClass transmit_class,
                                            TimePoint deadline);
  /// RPDOs that somebody sends and the kernel does not have yet, but for stops, never leave: `timeout` with
  /// Error::not_sent.
  void withdraw();

  /// A command of `object` goes by SDO now: its RPDO is not repeated before refresh(), or it would bring back the value
  /// of before; a repetition that waits to leave is withdrawn. However many writes follow each other and however long
  /// one takes, this keeps repetitions back by one period at most.
  void hold(ObjectAddress object);
  /// That SDO write is over. A repetition that was kept back, or left with the value of before, follows at once.
  void refresh(ObjectAddress object);
  /// The image says something else now: a repetition that waits with what was said before does not leave.
  void look_again();

  /// The node was lost, rebooted, left operational or is being removed: nothing is repeated until the next RPDO has
  /// left, and what waits to leave fails as `offline`.
  void cease();
  /// Returns once nothing is under way or waits; to be awaited after cease() before it goes.
  boost::asio::awaitable<void> until_idle();

 private:
  class Sending;
  struct Entry {
    Entry(Outputs& owner, const boost::asio::any_io_executor& executor, const PdoSettings& settings);

    PdoSettings settings;
    PdoPlan plan;
    Duration period;       ///< Of its repetition; zero: not repeated.
    bool repeats = false;  ///< One has left since it last ceased.
    TimePoint due{};       ///< Of the next repetition.
    /// Of the pause for SDO writes, which ends earlier when an RPDO has left. No time: no pause.
    TimePoint pause_end{};
    Ticket repetition{};  ///< The newest one since the last command or pause.
    Frame repeated{};     ///< What it holds.
    WakeUp wake_up;
  };

  [[nodiscard]] static bool maps(const Entry& entry, ObjectAddress object) noexcept;
  /// Nothing where a field is missing or one too many.
  [[nodiscard]] static std::optional<Frame> frame_of(const Entry& entry, std::span<const ObjectValue> values);
  [[nodiscard]] std::optional<Frame> wanted(const Entry& entry) const;
  [[nodiscard]] bool sends(const Entry& entry) const noexcept;
  void on_due(Entry& entry);
  void repeat(Entry& entry);
  [[nodiscard]] Error error(ErrorKind kind, std::string detail) const;

  Bus& bus_;
  std::uint8_t node_;
  Image image_;
  std::deque<Entry> entries_;
  std::vector<Sending*> sendings_;
  Event idle_;
};

}  // namespace canopen
