#include "canopen/node/find_state.h"

#include <algorithm>
#include <array>
#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/communication_objects.h"
#include "canopen/node/setup_session.h"
#include "canopen/sdo/client.h"

namespace canopen {
namespace {

constexpr std::uint32_t kErrorControl = 0x700;  // CiA 301 table 75.

using Sign = std::optional<FoundState>;

Sign sign_of(const Heard& heard) noexcept {
  if (heard.boot_up) {
    return FoundState::not_operational;
  }
  if (!heard.state) {
    return std::nullopt;
  }
  switch (*heard.state) {
    case NmtState::operational:
      return FoundState::operational;
    case NmtState::stopped:
      return FoundState::stopped;
    default:
      return FoundState::not_operational;
  }
}

/// Waits for a sign; with `or_tpdo` a TPDO ends it, too.
boost::asio::awaitable<Sign> listen(LifeContext context, Duration time, bool or_tpdo) {
  const TimePoint until = Clock::now() + time;
  while (!sign_of(context.heard) && !(or_tpdo && context.heard.tpdo) && !context.life.over() &&
         context.bus.may_still_hear(until)) {
    co_await context.life.wait_until(or_soon(until));
  }
  co_return sign_of(context.heard);
}

boost::asio::awaitable<Sign> ask_by_guarding(LifeContext context) {
  const bool harmless = co_await guarding_is_off(context);
  if (!harmless || context.life.over()) {
    co_return std::nullopt;
  }
  Frame request;
  request.id = kErrorControl + context.settings.node;
  request.size = 1;
  request.remote = true;
  context.heard.guarding_asked = true;
  const Ticket sent = context.bus.send(TransmitClass::control, request, Clock::now() + TransmitQueue::kLifeTime);
  const Sign sign = co_await listen(context, context.settings.sdo.timeout, false);
  context.heard.guarding_asked = false;
  co_return sign;
}

std::string slow_heartbeat_text(std::chrono::milliseconds period) {
  return "its heartbeat comes only every " + std::to_string(period.count()) +
         " ms (0x1017:00); before the next one nobody knows whether it runs, and it is left as it is";
}

}  // namespace

boost::asio::awaitable<bool> heartbeat_after(LifeContext context, TimePoint since) {
  const TimePoint until = Clock::now() + context.settings.error_control.heartbeat_timeout;
  while (context.bus.may_still_hear(until) && !context.life.over()) {
    if (context.heard.heartbeat_at && *context.heard.heartbeat_at >= since) {
      co_return true;
    }
    co_await context.life.wait_until(or_soon(until));
  }
  co_return false;
}

boost::asio::awaitable<bool> guarding_is_off(LifeContext context) {
  const std::array objects{std::pair{kGuardTime, DataType::u16}, std::pair{kLifeTimeFactor, DataType::u8}};
  for (const auto& [object, type] : objects) {
    const Result<Raw> value = co_await context.sdo.read(object, type);
    if (value.has_value() ? value.value() != 0 : !is_absent(value.error())) {
      co_return false;
    }
  }
  co_return true;
}

boost::asio::awaitable<FoundState> find_state(LifeContext context, std::function<void(std::string)> tell) {
  const ErrorControlSettings& control = context.settings.error_control;
  Sign sign = co_await listen(context, control.heartbeat_timeout, true);
  if (sign || context.life.over()) {
    co_return sign.value_or(FoundState::unknown);
  }
  const FoundState otherwise = context.heard.tpdo ? FoundState::operational : FoundState::silent;
  const Result<Raw> period = co_await context.sdo.probe(kProducerHeartbeat, DataType::u16);
  sign = sign_of(context.heard);
  if (sign || context.life.over()) {
    co_return sign.value_or(FoundState::unknown);
  }
  if (period.has_error() && period.error().kind != ErrorKind::refused) {
    const bool asked = !period.error().not_sent && period.error().kind != ErrorKind::offline;
    co_return asked ? otherwise : FoundState::not_asked;
  }
  const auto heartbeat = std::chrono::milliseconds(period.has_value() ? period.value() : 0);
  if (heartbeat > Duration::zero()) {
    if (heartbeat > control.heartbeat_timeout) {
      tell(slow_heartbeat_text(heartbeat));
    }
    // Where we listened that long already, none will come.
    const bool listened = !context.heard.tpdo && heartbeat <= control.heartbeat_timeout;
    const Duration enough = std::max<Duration>(heartbeat + heartbeat / 2, control.heartbeat_timeout);
    sign = co_await listen(context, listened ? Duration::zero() : enough, false);
  } else if (control.has_guarding) {
    sign = co_await ask_by_guarding(context);
  }
  co_return sign.value_or(context.heard.tpdo ? FoundState::operational : FoundState::unknown);
}

}  // namespace canopen
