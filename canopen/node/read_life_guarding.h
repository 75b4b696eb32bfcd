#pragma once

#include <boost/asio/awaitable.hpp>

#include "canopen/communication_objects.h"
#include "canopen/error.h"
#include "canopen/node/life_guarding.h"
#include "canopen/object.h"

namespace canopen {

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
