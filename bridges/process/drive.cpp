#include "bridges/process/drive.h"

#include <array>
#include <utility>

#include "bridges/alarms/fault_naming.h"

namespace process {
Drive::Drive(const boost::asio::any_io_executor& executor, const config::Drive& model, std::size_t index,
             canopen::Bus& bus, const std::vector<Observer*>& observers)
    : model_(model),
      index_(index),
      bus_(model.bus),
      observers_(&observers),
      image_(model),
      node_(executor, bus, model.node, *this),
      inputs_(
          model, image_, [this](std::uint16_t tpdo) { return node_.tpdo_verified(tpdo); }, *this),
      alarms_(model,
              [this](alarms::AlarmKind kind) { tell([&](Observer& observer) { observer.on_alarm(*this, kind); }); }),
      commands_(executor, model, node_, image_, *this),
      reader_(executor, model, node_, inputs_, alarms_),
      expiry_(executor,
              [this] {
                expiry_for_ = canopen::kNever;
                inputs_.expire(node_.heard_until());
                arm_expiry();
              }),
      settling_(executor, model, node_, image_, alarms_),
      fault_(indicator(model.faults.fault)),
      warning_(indicator(model.faults.warning)),
      running_(indicator(model.faults.running)),
      quick_stop_(indicator(model.faults.quick_stop)),
      fault_code_(indicator(model.faults.fault_code)) {}

template <class Tell>
void Drive::tell(Tell tell_one) const {
  for (Observer* observer : *observers_) {
    tell_one(*observer);
  }
}

void Drive::start() {
  if (!model_.enabled) {
    return;
  }
  settling_.start();
  node_.start();
  reader_.start();
}

void Drive::close() {
  commands_.close();
  node_.close();
}

boost::asio::awaitable<void> Drive::stop() {
  close();
  co_await node_.stop();
  co_await reader_.stop();
  co_await commands_.until_idle();
  expiry_.cancel();
  settling_.stop();
}

std::optional<Drive::Indicator> Drive::indicator(const std::optional<std::size_t>& signal) const {
  if (!signal) {
    return std::nullopt;
  }
  const auto id = static_cast<SignalId>(*signal);
  const SourceState* state = image_.source_of(id);
  if (state == nullptr) {
    return std::nullopt;
  }
  return Indicator{id, static_cast<SourceId>(state - image_.sources().data())};
}

void Drive::on_status(const canopen::NodeStatus& status) {
  commands_.on_status(status);
  inputs_.on_status(status.online, status.nmt_now() == canopen::NmtState::operational, canopen::Clock::now());
  alarms_.on_status(status, canopen::wall_now());
  if (std::exchange(told_doubled_, status.doubled) != status.doubled && doubled_changed_) {
    doubled_changed_();
  }
  if (std::exchange(was_online_, status.online) != status.online) {
    had_fault_ = false;
    had_quick_stop_ = false;
    if (status.online) {
      reader_.check_errors();
    } else {
      reader_.forget_errors();
      had_fault_emcy_.reset();
    }
    reader_.watch_errors();
  }
  settling_.on_status(status);
  arm_expiry();
  tell([&](Observer& observer) { observer.on_status(*this); });
}

void Drive::on_boot_up() {
  had_fault_emcy_ = false;
  commands_.on_boot_up();
  inputs_.on_boot_up();
  alarms_.on_boot_up(canopen::Clock::now(), canopen::wall_now());
}

void Drive::on_arrival(canopen::Arrival arrival) {
  if (arrival == canopen::Arrival::taken_over) {
    commands_.on_taken_over();
  }
  on_remark(arrival == canopen::Arrival::booted ? "configured" : "taken over as it runs");
}

void Drive::on_tpdo(std::uint16_t number, std::span<const canopen::Raw> values, canopen::TimePoint at,
                    canopen::WallTime wall) {
  inputs_.on_tpdo(number, values, at, wall);
}

void Drive::on_tpdo_length(std::uint16_t number, std::size_t expected, std::size_t received) {
  inputs_.on_tpdo_length(number, expected, received, canopen::Clock::now());
  arm_expiry();
}

void Drive::on_emcy(const canopen::Emcy& emcy, canopen::TimePoint at, canopen::WallTime wall) {
  if (emcy.reset) {
    if (had_fault_emcy_.value_or(true)) {
      commands_.on_fault_end();
    }
    // Where errors are left, a fault may stand yet.
    had_fault_emcy_ = had_fault_emcy_.value_or(true) && (emcy.error_register != 0 || emcy.remaining != 0);
  } else if (alarms::name_emcy(model_.faults, model_.node.emcy, emcy).severity == config::Severity::fault) {
    had_fault_emcy_ = true;
    commands_.on_fault_begin("an emergency came");
  } else {
    had_fault_emcy_ = had_fault_emcy_.value_or(false);
  }
  alarms_.on_emcy(emcy, at, wall);
  reader_.on_emergency(at);
  watch_bits(at);
}

void Drive::on_frames_lost() {
  had_fault_emcy_.reset();
  inputs_.on_frames_lost(canopen::Clock::now());
  if (was_online_) {
    // An emergency may have been among them.
    reader_.check_errors();
  }
}

void Drive::on_remark(const std::string& text) {
  tell([&](Observer& observer) { observer.on_remark(*this, text); });
}

void Drive::on_values(SourceId source) {
  void_commands(source);
  const std::vector<SignalId>& signals = inputs_.plans()[source].signals;
  tell([&](Observer& observer) { observer.on_values(*this, signals); });
  tell_alarms(source);
  settling_.on_values(source);
  arm_expiry();
}

void Drive::on_stale(SourceId source) {
  if (is_from(running_, source)) {
    was_running_ = false;
    commands_.on_standstill("nobody can tell whether the motor turns");
    tell_running(std::nullopt);
  }
  tell_stale_bit(fault_, config::Severity::fault, source);
  tell_stale_bit(warning_, config::Severity::warning, source);
  const std::vector<SignalId>& signals = inputs_.plans()[source].signals;
  tell([&](Observer& observer) { observer.on_freshness(*this, signals); });
}

void Drive::on_presence(SourceId source) {
  const std::vector<SignalId>& signals = inputs_.plans()[source].signals;
  tell([&](Observer& observer) { observer.on_freshness(*this, signals); });
}

void Drive::on_read_wanted() {
  reader_.wake();
  arm_expiry();
}

/// Called for each frame, tells changes only.
void Drive::tell_running(std::optional<bool> running) {
  if (std::exchange(told_running_, running) != running) {
    commands_.on_running(running);
    if (running == true) {
      alarms_.on_running(canopen::wall_now());
    }
  }
}

/// A run command that was given before a fault or a standstill is not to be carried along by a set-point after it. The
/// end of a fault counts too: what was commanded while the drive could not run must not start it later.
void Drive::void_commands(SourceId source) {
  if (is_from(running_, source)) {
    const bool running = image_.raw(running_->signal) != 0;
    if (std::exchange(was_running_, running) && !running) {
      commands_.on_standstill("the motor came to a stop");
    }
    tell_running(running);
  }
  if (is_from(quick_stop_, source)) {
    const bool quick_stop = image_.raw(quick_stop_->signal) != 0;
    if (!std::exchange(had_quick_stop_, quick_stop) && quick_stop) {
      on_quick_stop();
    }
  }
  if (is_from(fault_, source)) {
    const bool fault = image_.raw(fault_->signal) != 0;
    if (std::exchange(had_fault_, fault) != fault) {
      fault ? commands_.on_fault_begin("a fault began") : commands_.on_fault_end();
    }
  }
}

/// Repeating "enable operation" would end a quick stop that the drive entered by itself (CiA 402, transition 16). Where
/// it was commanded, the word that did it goes on: a drive that supervises its RPDOs would trip and perhaps coast.
void Drive::on_quick_stop() {
  constexpr canopen::Raw kNoQuickStop = 0x0004;  // Controlword bit 2, CiA 402.
  // Also the word of a stop that is on its way: a drive may show what it did before it confirms the write.
  const std::optional<canopen::Raw> word = commands_.commanded().repeated_control();
  if (word && (*word & kNoQuickStop) == 0) {
    commands_.on_standstill("a quick stop began");
  } else {
    commands_.on_fault_begin("a quick stop began");
  }
}

void Drive::on_commanded(std::span<const SignalId> signals) {
  for (const SignalId signal : signals) {
    inputs_.on_written(signal, commands_.commanded().shown(signal), canopen::Clock::now(), canopen::wall_now());
  }
  tell([&](Observer& observer) { observer.on_commanded(*this, signals); });
}

void Drive::on_control() {
  alarms_.on_control(commands_.control().alarm, canopen::wall_now());
  tell([&](Observer& observer) { observer.on_control(*this); });
}

void Drive::on_command_done(const CommandRecord& record, const Outcome& outcome) {
  if (record.writes_control && outcome.has_value()) {
    alarms_.on_control_command(canopen::wall_now());
  }
  tell([&](Observer& observer) { observer.on_command_done(*this, record, outcome); });
}

void Drive::tell_alarms(SourceId source) {
  if (is_from(fault_code_, source)) {
    alarms_.on_fault_code(image_.raw(fault_code_->signal), image_.sources()[source].wall);
  }
  tell_bit(fault_, config::Severity::fault, source);
  tell_bit(warning_, config::Severity::warning, source);
}

void Drive::tell_bit(const std::optional<Indicator>& indicator, config::Severity severity, SourceId source) {
  if (!is_from(indicator, source) || !was_online_) {
    return;
  }
  const SourceState& state = image_.sources()[source];
  alarms_.on_bit(severity, image_.raw(indicator->signal) != 0, inputs_.period_of(source), state.at, state.wall);
  watch_bits(state.at);
}

/// The end of an error must not wait for a signal that does not come.
void Drive::tell_stale_bit(const std::optional<Indicator>& indicator, config::Severity severity, SourceId source) {
  if (is_from(indicator, source)) {
    alarms_.on_stale_bit(severity, canopen::Clock::now());
    reader_.watch_errors();
  }
}

/// An on-change TPDO says nothing while nothing changes, so it is read as long as a further value would tell more.
void Drive::watch_bits(canopen::TimePoint now) {
  const auto undecided = [&](const std::optional<Indicator>& indicator, config::Severity severity, SourceId source) {
    return is_from(indicator, source) && alarms_.error_list().awaits_signal(severity);
  };
  for (const std::optional<Indicator>* indicator : {&fault_, &warning_}) {
    if (*indicator) {
      const SourceId source = (*indicator)->source;
      const bool wanted =
          undecided(fault_, config::Severity::fault, source) || undecided(warning_, config::Severity::warning, source);
      inputs_.watch(source, wanted, now);
    }
  }
  reader_.watch_errors();
}

void Drive::arm_expiry() {
  // Called for each frame: the clock is read only where the timer is set.
  const canopen::TimePoint next = inputs_.next_expiry();
  if (next < expiry_for_) {
    expiry_for_ = next;
    expiry_.arm(canopen::or_soon(next));
  }
}

}  // namespace process
