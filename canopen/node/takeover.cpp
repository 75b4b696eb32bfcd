#include "canopen/node/takeover.h"

#include "canopen/bus/bus.h"
#include "canopen/sdo/client.h"

namespace canopen {
namespace {

constexpr std::uint32_t kErrorControlBase = 0x700;
constexpr ObjectAddress kProducerHeartbeat{0x1017, 0};

std::optional<FoundState> sign_of(const NodeSigns& signs) noexcept {
  if (signs.boot_up) {
    return FoundState::not_operational;
  }
  if (!signs.state) {
    return std::nullopt;
  }
  switch (*signs.state) {
    case NmtState::operational:
      return FoundState::operational;
    case NmtState::stopped:
      return FoundState::stopped;
    default:
      return FoundState::not_operational;
  }
}

/// Waits for a sign; nothing where none comes, `interrupted` where the search is off.
boost::asio::awaitable<std::optional<FoundState>> listen(StateSearch search, Duration time) {
  const TimePoint until = Clock::now() + time;
  const std::uint64_t begun = search.sdo.interruptions();
  std::optional<FoundState> sign = sign_of(search.signs);
  while (!sign && search.bus.may_still_hear(until)) {
    co_await search.changed.wait_until(or_soon(until));
    sign = sign_of(search.signs);
    if (!sign && search.sdo.interruptions() != begun) {
      sign = FoundState::interrupted;
    }
  }
  co_return sign;
}

Ticket request_guarding(StateSearch search) {
  Frame request;
  request.id = kErrorControlBase + search.settings.node;
  request.size = 1;
  request.remote = true;
  return search.bus.send(TransmitClass::control, request, Clock::now() + TransmitQueue::kLifeTime);
}

}  // namespace

boost::asio::awaitable<FoundState> learn_state(StateSearch search) {
  std::optional<FoundState> sign = co_await listen(search, search.settings.error_control.heartbeat_timeout);
  if (sign) {
    co_return *sign;
  }
  const Result<Raw> period = co_await search.sdo.probe(kProducerHeartbeat, DataType::u16);
  sign = sign_of(search.signs);
  if (sign) {
    co_return *sign;
  }
  if (period.has_error() && period.error().kind == ErrorKind::timeout) {
    co_return FoundState::silent;
  }
  if (period.has_error() && period.error().kind == ErrorKind::offline) {
    co_return FoundState::interrupted;
  }
  const auto heartbeat = std::chrono::milliseconds(period.has_value() ? period.value() : 0);
  if (heartbeat > search.settings.error_control.heartbeat_timeout) {
    sign = co_await listen(search, heartbeat + heartbeat / 2);
  } else if (heartbeat == Duration::zero() && search.settings.error_control.has_guarding) {
    search.signs.guarding_asked = true;
    const Ticket request = request_guarding(search);
    sign = co_await listen(search, search.settings.sdo.timeout);
    search.signs.guarding_asked = false;
  }
  co_return sign.value_or(FoundState::not_operational);
}

boost::asio::awaitable<BootReport> inspect_running(SdoClient& sdo, const NodeSettings& settings) {
  SetupSession session(sdo, SetupPurpose::inspect);
  bool written = false;
  co_return co_await check_settings(session, settings, written);
}

}  // namespace canopen
