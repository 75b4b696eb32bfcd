#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "canopen/clock.h"
#include "canopen/object.h"
#include "config/model.h"

namespace process {

/// Position of a signal in config::Drive::signals.
using SignalId = std::uint16_t;
/// Position of a source in an image.
using SourceId = std::uint16_t;

/// Where values come from together: one TPDO, or one object polled by SDO.
struct SourceState {
  config::Source source;
  bool received = false;             ///< Since the drive's boot.
  bool absent = false;               ///< The drive does not have this object: never fresh, and nobody waits for it.
  canopen::TimePoint at{};           ///< Of the newest values.
  canopen::WallTime wall{};          ///< Likewise, for people.
  canopen::TimePoint fresh_until{};  ///< Values are fresh up to here; TimePoint::max() for as long as nothing happens.

  [[nodiscard]] bool fresh(canopen::TimePoint now) const noexcept { return received && now <= fresh_until; }
};

/// The newest value of every readable signal of one drive, as the drive holds it; time and quality per source.
/// Written only by Inputs; one PDO is written in one go, so that no reader ever sees half of it.
class Image {
 public:
  explicit Image(const config::Drive& model);

  /// 0 as long as nothing was received.
  [[nodiscard]] canopen::Raw raw(SignalId signal) const noexcept;
  [[nodiscard]] bool fresh(SignalId signal, canopen::TimePoint now) const noexcept;
  /// The drive does not have the object of this polled signal, as it said when it was asked last.
  [[nodiscard]] bool absent(SignalId signal) const noexcept;
  /// Nothing for a signal that is only written.
  [[nodiscard]] const SourceState* source_of(SignalId signal) const noexcept;
  [[nodiscard]] std::span<const SourceState> sources() const noexcept { return sources_; }
  /// Every source is fresh that the drive has.
  [[nodiscard]] bool all_fresh(canopen::TimePoint now) const noexcept;

 private:
  friend class Inputs;
  static constexpr SourceId kNoSource = 0xFFFF;

  std::vector<canopen::Raw> values_;
  std::vector<SourceId> source_of_;
  std::vector<SourceState> sources_;
};

}  // namespace process
