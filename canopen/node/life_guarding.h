#pragma once

#include "canopen/node/node_settings.h"
#include "canopen/object.h"

namespace canopen {

/// Guard time and life time factor of a node (0x100C, 0x100D). Where neither is 0, the first guarding request that it
/// receives starts its life guarding: from then on it trips when none comes for the product of both (CiA 301
/// §7.2.8.2.2.1).
struct LifeGuarding {
  Raw guard_time = 0;  ///< ms
  Raw factor = 0;

  [[nodiscard]] bool armed() const noexcept { return guard_time != 0 && factor != 0; }
  /// Nobody has set any of it.
  [[nodiscard]] bool unset() const noexcept { return guard_time == 0 && factor == 0; }
  friend bool operator==(const LifeGuarding&, const LifeGuarding&) = default;
};

/// What we write where the node is to trip without us: the period, and supervise_gateway / period, rounded up. Both 0
/// where it is not.
[[nodiscard]] LifeGuarding wanted_life_guarding(const ErrorControlSettings& control) noexcept;

/// A request of ours starts nothing that we do not want, or keep up.
[[nodiscard]] bool may_guard(const LifeGuarding& found, const ErrorControlSettings& control) noexcept;

}  // namespace canopen
