#include "bridges/process/commands.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "bridges/process/command_checks.h"
#include "canopen/node/remote_node.h"

namespace process {
namespace {

using boost::asio::awaitable;
using canopen::Error;
using canopen::ErrorKind;
using canopen::Result;

Error with_written(Error error, const std::string& written) {
  if (!written.empty()) {
    error.detail.append(error.detail.empty() ? "" : "; ").append("already written: ").append(written);
  }
  return error;
}

}  // namespace

Commands::Commands(boost::asio::any_io_executor executor, const config::Drive& model, canopen::RemoteNode& node,
                   Image& image, Told confirmed, Told unknown)
    : model_(model),
      node_(node),
      image_(image),
      confirmed_(std::move(confirmed)),
      unknown_(std::move(unknown)),
      queue_(std::move(executor)),
      sender_(model, node) {}

awaitable<Outcome> Commands::write(Origin origin, std::vector<FieldWrite> fields, StillStands still_stands) {
  const Arrival arrival = arrive();
  if (std::optional<Error> refused = refuse_writer(model_, origin.writer)) {
    co_return *std::move(refused);
  }
  Result<std::vector<Field>> checked = check_fields(model_, fields);
  if (checked.has_error()) {
    co_return checked.error();
  }
  if (std::optional<Error> refused = refuse_unreachable()) {
    co_return *std::move(refused);
  }
  const CommandQueue::Ticket ticket(queue_);
  std::optional<Error> late = co_await await_turn(ticket, arrival);
  if (late) {
    co_return *std::move(late);
  }
  Outcome outcome =
      co_await carry_out(in_writing_order(model_, std::move(checked.value())), arrival, std::move(still_stands));
  co_return outcome;
}

awaitable<Outcome> Commands::nmt(Origin origin, canopen::NmtCommand command) {
  const Arrival arrival = arrive();
  if (std::optional<Error> refused = refuse_writer(model_, origin.writer)) {
    co_return *std::move(refused);
  }
  if (queue_.closed()) {
    co_return no_turn();
  }
  if (node_.status().boot_result != canopen::BootResult::left_alone) {
    if (std::optional<Error> refused = refuse_nmt(command, running())) {
      co_return *std::move(refused);
    }
  }
  const CommandQueue::Ticket ticket(queue_);
  const bool has_turn = co_await queue_.turn(ticket, arrival.deadline);
  if (!has_turn) {
    co_return no_turn();
  }
  // A run command may have been before it in the queue.
  std::optional<Error> refused = co_await refuse_nmt_now(command);
  if (refused) {
    co_return *std::move(refused);
  }
  Outcome outcome = co_await node_.command(command, arrival.deadline);
  co_return outcome;
}

awaitable<Result<canopen::Raw>> Commands::sdo_read(canopen::ObjectAddress object, canopen::DataType type) {
  if (queue_.closed()) {
    co_return no_turn();
  }
  const CommandQueue::Visit visit(queue_);
  Result<canopen::Raw> answer = co_await node_.read(object, type);
  co_return answer;
}

awaitable<Outcome> Commands::sdo_write(Origin origin, canopen::ObjectValue value) {
  const Arrival arrival = arrive();
  if (const std::optional<SignalId> signal = writable_signal(model_, value.object)) {
    const canopen::DataType type = model_.signals[*signal].type;
    if (type != value.type) {
      Error wrong = error(ErrorKind::type, model_.signals[*signal].name + " is " + std::string(name_of(type)));
      wrong.object = value.object;
      co_return wrong;
    }
    std::vector<FieldWrite> fields{{*signal, canopen::normalise(type, value.raw)}};
    Outcome outcome = co_await write(std::move(origin), std::move(fields));
    co_return outcome;
  }
  std::optional<Error> refused = refuse_writer(model_, origin.writer);
  if (!refused) {
    refused = refuse_raw(model_, value.object);
  }
  if (!refused) {
    refused = refuse_unreachable();
  }
  if (refused) {
    refused->object = value.object;
    co_return *std::move(refused);
  }
  const CommandQueue::Ticket ticket(queue_);
  std::optional<Error> late = co_await await_turn(ticket, arrival);
  if (late) {
    co_return *std::move(late);
  }
  Outcome outcome = co_await node_.write(value.object, value.type, value.raw, arrival.deadline);
  co_return outcome;
}

void Commands::on_status(const canopen::NodeStatus& status) {
  const bool live = status.online && status.nmt == canopen::NmtState::operational;
  if (std::exchange(live_, live) && !live) {
    ++session_;
    sender_.on_voided();
  }
}

void Commands::on_boot_up() {
  ++session_;
  sender_.on_voided();
}

void Commands::on_fault() {
  sender_.make_void(false);
}

void Commands::on_standstill() {
  // A drive that supervises its RPDOs would trip at standstill if they ended.
  sender_.make_void(true);
}

Commands::Arrival Commands::arrive() const {
  return {canopen::Clock::now() + model_.commands.deadline, session_, sender_.knowledge()};
}

std::optional<Error> Commands::refuse_unreachable() const {
  if (queue_.closed()) {
    return no_turn();
  }
  const canopen::NodeStatus& status = node_.status();
  if (!status.online || !status.configured) {
    return error(ErrorKind::offline,
                 status.nmt == canopen::NmtState::unknown ? "the drive is offline" : "the drive is not booted");
  }
  if (status.nmt != canopen::NmtState::operational) {
    return error(ErrorKind::offline, "the drive is " + std::string(name_of(status.nmt)) + ", not operational");
  }
  return std::nullopt;
}

std::optional<Error> Commands::refuse_nmt(canopen::NmtCommand command, std::optional<bool> running) const {
  if (command == canopen::NmtCommand::start || model_.commands.nmt_while_running || running == false) {
    return std::nullopt;
  }
  return error(ErrorKind::forbidden,
               std::string(running ? "the motor runs" : "nobody can tell whether the motor runs") +
                   "; nmt_while_running would allow it");
}

awaitable<std::optional<Error>> Commands::refuse_nmt_now(canopen::NmtCommand command) {
  std::optional<bool> runs = running();
  const bool matters = command != canopen::NmtCommand::start && !model_.commands.nmt_while_running;
  if (!runs && matters && node_.status().boot_result == canopen::BootResult::left_alone) {
    runs = co_await node_.motor_runs();  // Nothing that it sends can be trusted, but it answers.
  }
  co_return queue_.closed() ? no_turn() : refuse_nmt(command, runs);
}

awaitable<std::optional<Error>> Commands::await_turn(const CommandQueue::Ticket& ticket, Arrival arrival) {
  const bool has_turn = co_await queue_.turn(ticket, arrival.deadline);
  if (!has_turn) {
    co_return no_turn();
  }
  if (std::optional<Error> refused = refuse_new_session(arrival)) {
    co_return refused;
  }
  co_return refuse_unreachable();
}

awaitable<Outcome> Commands::carry_out(std::vector<Field> remaining, Arrival arrival, StillStands still_stands) {
  std::string written;
  bool allow_rpdo = true;
  while (!remaining.empty()) {
    if (std::optional<Error> outlived = refuse_outlived(still_stands)) {
      co_return with_written(*std::move(outlived), written);
    }
    const WriteStep step = next_step(model_, node_, remaining, allow_rpdo);
    Outcome outcome = co_await sender_.send(step, arrival.knowledge, arrival.deadline, still_stands);
    const bool withdrawn = step.rpdo != 0 && outcome.has_error() && outcome.error().kind == ErrorKind::incomplete;
    tell(step, outcome, arrival);
    if (outcome.has_value()) {
      for (const Field& field : step.fields) {
        written += (written.empty() ? "" : ", ") + model_.signals[field.signal].name;
        std::erase_if(remaining, [&](const Field& other) { return other.signal == field.signal; });
      }
    }
    if ((outcome.has_value() || withdrawn) && !remaining.empty()) {
      // Fault or standstill took away what a withdrawn RPDO relied on; it was not sent, so its fields go one by one.
      allow_rpdo = allow_rpdo && !withdrawn;
      std::optional<Error> over = refuse_new_session(arrival);
      outcome = over ? Outcome(*std::move(over)) : Outcome();
    }
    if (outcome.has_error()) {
      co_return with_written(outcome.error(), written);
    }
  }
  co_return Outcome();
}

std::optional<Error> Commands::refuse_outlived(const StillStands& still_stands) {
  if (!running()) {
    // Nobody can tell whether the motor came to a stop since earlier commands.
    on_standstill();
  }
  if (still_stands && !still_stands()) {
    return error(ErrorKind::incomplete, "not begun: what it was made from has changed");
  }
  return std::nullopt;
}

void Commands::tell(const WriteStep& step, const Outcome& outcome, const Arrival& arrival) {
  const std::vector<SignalId> signals = signals_of(step);
  if (outcome.has_value()) {
    for (const Field& field : step.fields) {
      image_.commanded_[field.signal] = field.raw;
    }
    confirmed_(signals);
  }
  // What a command was worth may have ended before its confirmation came.
  const bool outdated = session_ != arrival.session || sender_.knowledge() != arrival.knowledge;
  if (outcome.has_value() ? outdated : outcome.error().outcome_unknown) {
    unknown_(signals);
  }
}

std::vector<SignalId> Commands::signals_of(const WriteStep& step) {
  std::vector<SignalId> signals;
  for (const Field& field : step.fields) {
    signals.push_back(field.signal);
  }
  std::sort(signals.begin(), signals.end());
  return signals;
}

std::optional<bool> Commands::running() const {
  const auto& running = model_.faults.running;
  if (!running || !image_.fresh(static_cast<SignalId>(*running), canopen::Clock::now())) {
    return std::nullopt;
  }
  return image_.raw(static_cast<SignalId>(*running)) != 0;
}

std::optional<Error> Commands::refuse_new_session(Arrival arrival) const {
  if (queue_.closed()) {
    return no_turn();
  }
  if (session_ == arrival.session) {
    return std::nullopt;
  }
  return error(ErrorKind::offline, "the drive rebooted, was lost or left operational meanwhile");
}

Error Commands::no_turn() const {
  if (queue_.closed()) {
    return error(ErrorKind::offline, "the gateway does not serve this drive any more");
  }
  const auto deadline = std::chrono::duration_cast<std::chrono::milliseconds>(model_.commands.deadline);
  return error(ErrorKind::timeout, "not begun within " + std::to_string(deadline.count()) + " ms and withdrawn");
}

Error Commands::error(ErrorKind kind, std::string detail) const {
  return command_error(model_, kind, std::move(detail));
}

}  // namespace process
