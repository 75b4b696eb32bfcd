#include "canopen/node/life_guarding.h"

namespace canopen {
LifeGuarding wanted_life_guarding(const ErrorControlSettings& control) noexcept {
  if (kind_of(control) != ErrorControlKind::guarding || control.supervise_gateway <= Duration::zero()) {
    return {};
  }
  using std::chrono::milliseconds;
  const auto period = std::chrono::duration_cast<milliseconds>(control.guarding).count();
  const auto limit = std::chrono::duration_cast<milliseconds>(control.supervise_gateway).count();
  return {static_cast<Raw>(period), static_cast<Raw>((limit + period - 1) / period)};
}

bool may_guard(const LifeGuarding& found, const ErrorControlSettings& control) noexcept {
  return !found.armed() || found == wanted_life_guarding(control);
}

}  // namespace canopen
