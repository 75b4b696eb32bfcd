#include "canopen/node/error_control_setup.h"

#include <utility>

#include "canopen/communication_objects.h"
#include "canopen/node/consumer_setup.h"
#include "canopen/node/life_guarding.h"
#include "canopen/node/node_guarding.h"
#include "canopen/node/read_life_guarding.h"
#include "canopen/node/wanted_objects.h"

namespace canopen {
namespace {

using Failure = std::optional<BootFailure>;
using Remarks = std::vector<std::string>;

boost::asio::awaitable<Failure> make_so(SetupSession& session, SetupItem item, Remarks& remarks) {
  SetupOutcome outcome = co_await session.ensure(std::move(item));
  if (!outcome.remark.empty()) {
    remarks.push_back(std::move(outcome.remark));
  }
  co_return std::move(outcome.failure);
}

std::string foreign_life_guarding_text(const LifeGuarding& found) {
  return to_string(kGuardTime) + " guard time is " + std::to_string(found.guard_time) + " ms and " +
         to_string(kLifeTimeFactor) + " life time factor " + std::to_string(found.factor) +
         ": another master has set life guarding. No guarding request is sent, for the first one starts it, and then "
         "the drive trips without them; set both to 0 there, or set supervise_gateway";
}

boost::asio::awaitable<Failure> write_life_guarding(SetupSession& session, const LifeGuarding& wanted,
                                                    Remarks& remarks) {
  SetupItem guard_time{kGuardTime, DataType::u16, wanted.guard_time, "guard time", SetupPolicy::write};
  Failure failure = co_await make_so(session, std::move(guard_time), remarks);
  if (!failure) {
    SetupItem factor{kLifeTimeFactor, DataType::u8, wanted.factor, "life time factor", SetupPolicy::write};
    failure = co_await make_so(session, std::move(factor), remarks);
  }
  co_return failure;
}

/// Requests that went on after a loss keep up what is another master's. What they told of the node nothing tells now.
void end_requests(const LifeContext& context) {
  if (context.guarding.running()) {
    context.guarding.stop();
    context.heard.by_guarding = true;
  }
}

boost::asio::awaitable<Failure> set_up_life_guarding(SetupSession& session, Remarks& remarks) {
  const ErrorControlSettings& control = session.context().settings.error_control;
  const LifeGuarding wanted = wanted_life_guarding(control);
  if (!wanted.unset()) {
    Failure failure = co_await write_life_guarding(session, wanted, remarks);
    if (failure && failure->letter == BootResult::left_alone) {
      end_requests(session.context());
    }
    co_return failure;
  }
  const Result<LifeGuarding> found = co_await read_life_guarding(session);
  if (found.has_error()) {
    co_return session.failure(found.error(), "guard time and life time factor");
  }
  if (may_guard(found.value(), control)) {
    co_return std::nullopt;
  }
  end_requests(session.context());
  co_return session.difference(foreign_life_guarding_text(found.value()));
}

}  // namespace

boost::asio::awaitable<ErrorControlOutcome> set_up_heartbeat(SetupSession& session, Remarks& remarks) {
  const ErrorControlSettings& control = session.context().settings.error_control;
  ErrorControlOutcome outcome{.failure = {}, .kind = kind_of(control)};
  const unsigned written = session.written();
  SetupItem item = wanted_heartbeat(control);
  const bool wanted = item.wanted != 0;
  SetupOutcome heartbeat = co_await session.ensure(std::move(item));
  outcome.heartbeat_as_wanted = wanted && heartbeat.confirmed && !heartbeat.will_do && !heartbeat.failure;
  outcome.failure = std::move(heartbeat.failure);
  outcome.heartbeat_written = session.written() != written;
  if (outcome.kind == ErrorControlKind::guarding && heartbeat.will_do) {
    outcome.kind = ErrorControlKind::heartbeat;
  }
  if (!heartbeat.remark.empty() && (wanted || !heartbeat.absent)) {
    remarks.push_back(std::move(heartbeat.remark));
  }
  co_return outcome;
}

boost::asio::awaitable<ErrorControlOutcome> set_up_error_control(SetupSession& session, Remarks& remarks) {
  const NodeSettings& settings = session.context().settings;
  const ErrorControlSettings& control = settings.error_control;
  ErrorControlOutcome outcome{.failure = {}, .kind = kind_of(control)};
  const bool to_guard = outcome.kind == ErrorControlKind::guarding;
  // What we may not change is looked at before a heartbeat is taken away. Where we may, the heartbeat goes first: the
  // two exclude each other.
  const bool look_first = to_guard && !session.inspecting() && wanted_life_guarding(control).unset();
  if (look_first) {
    outcome.failure = co_await set_up_life_guarding(session, remarks);
  }
  if (!outcome.failure) {
    outcome = co_await set_up_heartbeat(session, remarks);
  }
  if (!outcome.failure && outcome.kind == ErrorControlKind::guarding && !look_first) {
    outcome.failure = co_await set_up_life_guarding(session, remarks);
  }
  if (!outcome.failure && session.context().life.over()) {
    // With the last answer came a boot-up, or the end: what was read is that of before.
    outcome.failure = BootFailure{.interrupted = true};
  }
  if (outcome.failure) {
    co_return outcome;
  }
  if (outcome.kind == ErrorControlKind::guarding) {
    session.context().guarding.start();
  }
  if (outcome.kind != ErrorControlKind::guarding && !to_guard && control.supervise_gateway > Duration::zero() &&
      settings.gateway_node != 0) {
    outcome.failure = co_await set_up_consumer(session, remarks);
  } else {
    co_await look_at_consumers(session, remarks);
  }
  co_return outcome;
}

}  // namespace canopen
