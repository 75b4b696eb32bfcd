// Leases, signs of life, and what a time-out does.

#include <boost/asio/co_spawn.hpp>
#include <exception>
#include <memory>
#include <utility>

#include "bridges/process/commands.h"
#include "canopen/node/remote_node.h"

namespace process {

using boost::asio::awaitable;

namespace {

// Until a motor that was told to run shows it.
constexpr canopen::Duration kObeys = std::chrono::seconds(1);

}  // namespace

ControlSettings Commands::control_settings(const config::Commands& commands) {
  return {.lease = commands.lease,
          .timeout = commands.timeout,
          .feedback = commands.feedback,
          .on_timeout = commands.on_timeout};
}

void Commands::on_running(std::optional<bool> running) {
  control_.on_running(running, canopen::Clock::now());
  control_changed();
}

void Commands::on_taken_over() {
  control_.on_taken_over(running(), canopen::Clock::now());
  control_changed();
}

void Commands::on_sign_of_life(const Writer& writer) {
  control_.on_sign_of_life(writer, canopen::Clock::now());
  control_changed();
}

void Commands::control_changed() {
  ControlState state = control_.state();
  const bool differs = state != told_;
  told_ = std::move(state);
  if (!closed_) {
    control_time_.arm(canopen::or_soon(control_.next_time()));
  }
  if (differs) {
    listener_.on_control();
  }
}

void Commands::on_control_time() {
  const CommandTimeout::Action action = control_.expire(canopen::Clock::now());
  if (action == CommandTimeout::Action::cease) {
    commanded_.on_fault_begin("no sign of life of its writer");
    on_void();
  } else if (action == CommandTimeout::Action::write_values && !closed_) {
    boost::asio::co_spawn(executor_, write_timeout_values(std::make_unique<Visit>(*this)),
                          [](const std::exception_ptr& failure) {
                            if (failure) {
                              std::rethrow_exception(failure);
                            }
                          });
  }
  control_changed();
}

awaitable<void> Commands::write_timeout_values(std::unique_ptr<Visit> /*visit*/) {
  PendingCommand command = arrive({.writer = {.way = Writer::Way::gateway, .address = {}}}, CommandRecord::Kind::write);
  std::vector<FieldWrite> values;
  for (const config::TimeoutValue& value : model_.commands.timeout_values) {
    values.push_back({static_cast<SignalId>(value.signal), value.raw});
  }
  take_fields(command, values);
  command.passes_lease = true;
  Outcome outcome;
  if (command.use == ControlUse::stop) {
    outcome = co_await overtake(command, std::move(values));
  } else {
    StopParts parts = take_apart(command, values);
    outcome = co_await write_first(command, std::move(parts.fields));
    if (outcome.has_value() && parts.left_out) {
      outcome = *std::move(parts.left_out);
    }
  }
  finish(command, outcome);
  if (outcome.has_error()) {
    control_.on_values_failed(canopen::to_string(outcome.error()), canopen::Clock::now());
  } else {
    control_.on_values_confirmed();
  }
  control_changed();
}

bool Commands::is_told_to_run(canopen::TimePoint seen) const {
  const std::optional<SignalId> control = commanded_.control();
  if (!control) {
    return false;
  }
  const std::optional<canopen::Raw> known = commanded_.known(*control);
  const PendingCommand* const under_way = lane_.under_way();
  if ((known && use_of_control(*known) == ControlUse::run) ||
      (under_way != nullptr && (under_way->use == ControlUse::run || under_way->use == ControlUse::momentary))) {
    return true;
  }
  // A momentary one, perhaps of a jog, never counts, nor does one of unknown outcome.
  const std::optional<canopen::TimePoint> confirmed = commanded_.last_confirmed_at(*control);
  const std::optional<canopen::TimePoint> doubtful = commanded_.doubtful_at(*control);
  return (confirmed && *confirmed + kObeys > seen && use_of_control(commanded_.shown(*control)) != ControlUse::stop) ||
         (doubtful && *doubtful + kObeys > seen);
}

}  // namespace process
