#pragma once

#include <boost/asio/awaitable.hpp>

#include "canopen/communication_objects.h"
#include "canopen/error.h"
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

/// Objects that the node does not have count as 0. `reader` is a SdoClient or a SetupSession and outlives the call.
template <class Reader>
boost::asio::awaitable<Result<LifeGuarding>> read_life_guarding(Reader& reader) {
  const Result<Raw> guard_time = co_await reader.read(kGuardTime, DataType::u16);
  if (guard_time.has_error() && !is_absent(guard_time.error())) {
    co_return guard_time.error();
  }
  const Result<Raw> factor = co_await reader.read(kLifeTimeFactor, DataType::u8);
  if (factor.has_error() && !is_absent(factor.error())) {
    co_return factor.error();
  }
  co_return LifeGuarding{guard_time.has_value() ? guard_time.value() : 0, factor.has_value() ? factor.value() : 0};
}

}  // namespace canopen
