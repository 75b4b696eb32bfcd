#pragma once

#include <cstdint>
#include <string_view>

#include "canopen/frame.h"
#include "simulator/traits.h"

namespace simulator {

class Drive;

/// How contact with the master was lost.
enum class ConnectionLoss : std::uint8_t { heartbeat, life_guarding, rpdo_deadline };

/// What tells one kind of drive from another: its objects, its commands, its faults.
class Model {
 public:
  virtual ~Model() = default;
  Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  [[nodiscard]] virtual std::string_view kind() const = 0;
  [[nodiscard]] virtual const Traits& traits() const = 0;

  /// At power-on and at reset node: everything anew except what the drive keeps without power. Fills the dictionary.
  virtual void start(Drive& drive) = 0;
  /// The motor has moved; life bits and the like go on.
  virtual void step(canopen::Duration passed) = 0;

  virtual void raise_fault(std::uint16_t code) = 0;
  virtual void raise_warning(std::uint16_t code) = 0;
  /// Faults and warnings are gone, as after a reset at the drive's own panel.
  virtual void clear_faults() = 0;
  [[nodiscard]] virtual std::uint16_t fault() const = 0;    ///< 0: none
  [[nodiscard]] virtual std::uint16_t warning() const = 0;  ///< 0: none

  /// The board has reported the loss by EMCY already; this is what the drive makes of it.
  virtual void on_connection_lost(ConnectionLoss /*loss*/) {}
  /// After the mapped objects of RPDO `number` were written.
  virtual void on_rpdo(std::uint8_t /*number*/, const canopen::Frame& /*frame*/) {}
  [[nodiscard]] virtual AnswerStyle answer_style(Address /*address*/, bool /*write*/) const { return {}; }
};

}  // namespace simulator
