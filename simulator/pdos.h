#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "canopen/frame.h"
#include "simulator/pdo_settings.h"
#include "simulator/receive_pdo.h"
#include "simulator/transmit_pdo.h"

namespace simulator {

/// All PDOs of a drive and the objects 0x1400..0x1BFF that set them.
class Pdos {
 public:
  explicit Pdos(PdoContext context);

  /// At power-on, with the kind's rules.
  void start(const PdoRules& rules);
  /// Every PDO as the factory set it.
  void restore_defaults();
  void define(ObjectDictionary& dictionary);

  void enter_operational();
  void leave_operational();

  /// True when the frame was one of its PDOs. Call in operational only.
  bool on_frame(const canopen::Frame& frame);
  /// An enabled RPDO writes the object.
  [[nodiscard]] bool receives(Address address) const;
  void on_sync(std::optional<std::uint8_t> counter);
  void look_for_changes();

 private:
  PdoContext context_;
  std::vector<std::unique_ptr<TransmitPdo>> transmit_;
  std::vector<std::unique_ptr<ReceivePdo>> receive_;
};

}  // namespace simulator
