#include "canopen/node/find_state.h"

#include <algorithm>

#include "canopen/bus/bus.h"
#include "canopen/communication_objects.h"
#include "canopen/node/life_guarding.h"
#include "canopen/node/node_guarding.h"
#include "canopen/node/read_life_guarding.h"
#include "canopen/sdo/client.h"

namespace canopen {
namespace {

using Sign = std::optional<FoundState>;

Sign sign_of(const Heard& heard) noexcept {
  if (!heard.state) {
    return heard.boot_up ? Sign(FoundState::not_operational) : std::nullopt;
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
  while (!sign_of(context.heard) && !(or_tpdo && context.heard.tpdo_at) && !context.life.over() &&
         context.bus.may_still_hear(until)) {
    co_await context.life.wait_until(or_soon(until));
  }
  co_return sign_of(context.heard);
}

/// Where that is how the drive is supervised, the requests go on from here.
boost::asio::awaitable<Sign> ask_by_guarding(LifeContext context) {
  const ErrorControlSettings& control = context.settings.error_control;
  const bool goes_on = kind_of(control) == ErrorControlKind::guarding;
  const Result<LifeGuarding> found = co_await read_life_guarding(context.sdo);
  if (context.life.over() || found.has_error()) {
    co_return std::nullopt;
  }
  if (goes_on && may_guard(found.value(), control)) {
    context.guarding.start();
    co_return co_await listen(context, control.heartbeat_timeout, false);
  }
  if (goes_on || !found.value().unset()) {
    context.guarding.stop();
    co_return std::nullopt;
  }
  context.heard.guarding_asked = true;
  context.guarding.ask();
  const Sign sign = co_await listen(context, context.settings.sdo.timeout, false);
  context.heard.guarding_asked = false;
  context.guarding.stop();
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
    const bool told = !context.guarding.running() || context.guarding.alternates();
    if (told && context.heard.heartbeat_at && *context.heard.heartbeat_at >= since) {
      co_return true;
    }
    co_await context.life.wait_until(or_soon(until));
  }
  co_return false;
}

boost::asio::awaitable<FoundState> find_state(LifeContext context, const std::function<void(std::string)>& tell) {
  const ErrorControlSettings& control = context.settings.error_control;
  Sign sign = co_await listen(context, control.heartbeat_timeout, true);
  if (sign || context.life.over()) {
    co_return sign.value_or(FoundState::unknown);
  }
  const FoundState otherwise = context.heard.tpdo_at ? FoundState::operational : FoundState::silent;
  const Result<Raw> period = co_await context.sdo.probe(kProducerHeartbeat, DataType::u16);
  sign = sign_of(context.heard);
  if (sign || context.life.over()) {
    co_return sign.value_or(FoundState::unknown);
  }
  if (period.has_error() && (period.error().not_sent || period.error().kind == ErrorKind::offline)) {
    co_return FoundState::not_asked;
  }
  if (period.has_error() && period.error().kind == ErrorKind::timeout) {
    co_return otherwise;
  }
  const auto heartbeat = std::chrono::milliseconds(period.has_value() ? period.value() : 0);
  if (heartbeat > Duration::zero()) {
    if (heartbeat > control.heartbeat_timeout) {
      tell(slow_heartbeat_text(heartbeat));
    }
    // Where we listened that long already, none will come.
    const bool listened = !context.heard.tpdo_at && heartbeat <= control.heartbeat_timeout;
    const Duration enough = std::max<Duration>(heartbeat + heartbeat / 2, control.heartbeat_timeout);
    sign = co_await listen(context, listened ? Duration::zero() : enough, false);
  } else if (control.has_guarding || kind_of(control) == ErrorControlKind::guarding) {
    sign = co_await ask_by_guarding(context);
  }
  co_return sign.value_or(context.heard.tpdo_at ? FoundState::operational : FoundState::unknown);
}

}  // namespace canopen
