#include "simulator/drive.h"

#include <chrono>
#include <utility>

namespace simulator {
namespace {

/// A TPDO that knows no event timer, or not with its type, stays as it is.
PdoRules commissioned(PdoRules rules, const DriveOptions& options) {
  if (options.tpdo_event_ms) {
    for (std::size_t i = 0; i < rules.transmit.size(); ++i) {
      PdoDefaults& tpdo = rules.transmit[i];
      if (rules.triggers(static_cast<std::uint8_t>(i + 1), tpdo.type, *options.tpdo_event_ms)) {
        tpdo.event = *options.tpdo_event_ms;
      }
    }
  }
  return rules;
}

}  // namespace

Drive::Drive(std::unique_ptr<Model> model, std::uint8_t node, Network& network, const DriveOptions& options)
    : model_(std::move(model)),
      node_(node),
      network_(network),
      options_(options),
      motor_(options.motor),
      emergency_(node, [this](std::uint32_t id, const EmergencyMessage& message) { send_emergency(id, message); }),
      sdo_(
          node, dictionary_, record_,
          [this](Address address, bool write) { return model_->answer_style(address, write); },
          [this](Address address) { return refuse_sdo_write(address); },
          [this](Address address) { return denial(misbehaviour_, address); }),
      pdos_(pdo_context()),
      error_control_(network.executor(), error_control_actions()),
      heartbeat_consumer_(
          network.executor(), [this](std::uint8_t sub, std::uint8_t producer) { on_heartbeat_lost(sub, producer); },
          [this](std::uint8_t sub, std::uint8_t /*producer*/) { emergency_.clear(ErrorSource::heartbeat, sub); }),
      answer_alarm_(network.executor(), [this] { answer_due(); }),
      boot_alarm_(network.executor(), [this] { boot(); }) {
  network_.attach(*this);
}

Drive::~Drive() {
  network_.detach(*this);
}

ErrorControl::Actions Drive::error_control_actions() {
  ErrorControl::Actions actions;
  actions.state = [this] { return static_cast<std::uint8_t>(state_); };
  actions.heartbeat = [this](std::uint8_t status) {
    ++record_.heartbeats;
    send_status(status);
  };
  actions.guarding_answer = [this](std::uint8_t status) {
    ++record_.guarding_answers;
    emergency_.clear(ErrorSource::life_guarding);
    send_status(misbehaviour_.toggle_stuck ? static_cast<std::uint8_t>(status & kStateBits) : status);
  };
  actions.life_guarding_lost = [this] {
    emergency_.raise(ErrorSource::life_guarding, {0x8130, kCommunicationError, {}});
    on_connection_lost(ConnectionLoss::life_guarding);
  };
  return actions;
}

PdoContext Drive::pdo_context() {
  PdoContext context{.executor = network_.executor(),
                     .node = node_,
                     .dictionary = dictionary_,
                     .record = record_,
                     .rules = {},
                     .state = [this] { return state_; },
                     .local = [this] { return misbehaviour_.local; },
                     .send = {},
                     .received = {},
                     .length_error = {},
                     .length_right = {},
                     .deadline_missed = {}};
  context.send = [this](const canopen::Frame& frame) { send(with_length(frame, misbehaviour_.tpdo_length)); };
  context.received = [this](std::uint8_t number, const canopen::Frame& frame) { model_->on_rpdo(number, frame); };
  context.length_error = [this](std::uint8_t number, bool too_long) { on_rpdo_length_error(number, too_long); };
  context.length_right = [this](std::uint8_t number) {
    emergency_.clear(ErrorSource::rpdo_length, number);
    emergency_.clear(ErrorSource::rpdo_deadline, number);
  };
  context.deadline_missed = [this](std::uint8_t number) {
    emergency_.raise(ErrorSource::rpdo_deadline, {0x8250, kCommunicationError, {}}, number);
    model_->on_connection_lost(ConnectionLoss::rpdo_deadline);
  };
  return context;
}

void Drive::power_on() {
  if (!powered()) {
    restart();
  }
}

void Drive::power_off() {
  stop_communication();
  boot_alarm_.stop();
  motor_.switch_off();
  state_ = NmtState::off;
}

void Drive::reboot(canopen::Duration pause) {
  power_off();
  boot_alarm_.start(pause + options_.boot_time);
}

/// Power-on and reset node.
void Drive::restart() {
  stop_communication();
  boot_alarm_.stop();
  motor_.coast();
  state_ = NmtState::initialising;
  if (options_.boot_time > canopen::Duration::zero()) {
    boot_alarm_.start(options_.boot_time);
  } else {
    boot();
  }
}

void Drive::boot() {
  motor_.switch_off();
  emergency_.forget_errors();
  dictionary_.clear();
  pdos_.start(commissioned(model_->traits().pdo, options_));
  restore_communication_settings();
  define_communication_objects();
  define_trouble_object();
  model_->start(*this);
  start_communication();
}

void Drive::stop_communication() {
  enter(NmtState::initialising);
  error_control_.stop();
  heartbeat_consumer_.restart();
  emergency_.forget_communication_errors();
  late_answers_.clear();
  answer_alarm_.stop();
  boot_up_waiting_ = false;
}

void Drive::start_communication() {
  sdo_.start(model_->traits());
  state_ = NmtState::pre_operational;
  send_boot_up();
  error_control_.start();
}

void Drive::restore_communication_settings() {
  const Traits& traits = model_->traits();
  emergency_.restore_defaults(misbehaviour_.emcy_id);
  pdos_.restore_defaults();
  error_control_.restore_defaults(options_.heartbeat_ms.value_or(0), options_.guard_ms, options_.life_factor);
  heartbeat_consumer_.restore_defaults(traits.heartbeat_consumers);
  error_behaviour_ = 0;
  sync_cob_id_ = kSyncCobId;
  sync_overflow_ = 0;
}

void Drive::enter(NmtState state) {
  if (state_ == state) {
    return;
  }
  if (state_ == NmtState::operational) {
    pdos_.leave_operational();
  }
  if (state == NmtState::stopped) {
    late_answers_.clear();  // No SDO in stopped, not even an answer.
    answer_alarm_.stop();
  }
  state_ = state;
  if (state_ == NmtState::operational) {
    pdos_.enter_operational();
  }
}

void Drive::fault(std::uint16_t code) {
  if (powered()) {
    model_->raise_fault(code);
  }
}

void Drive::warning(std::uint16_t code) {
  if (powered()) {
    model_->raise_warning(code);
  }
}

void Drive::clear_faults() {
  if (powered()) {
    model_->clear_faults();
  }
}

void Drive::go(NmtState state) {
  const bool sensible =
      state == NmtState::stopped || state == NmtState::pre_operational || state == NmtState::operational;
  if (sensible && powered() && state_ != NmtState::initialising) {
    enter(state);
  }
}

void Drive::on_heartbeat_lost(std::uint8_t sub, std::uint8_t node) {
  emergency_.raise(ErrorSource::heartbeat, {0x8130, kCommunicationError, {sub, node}}, sub);
  on_connection_lost(ConnectionLoss::heartbeat);
}

void Drive::on_connection_lost(ConnectionLoss loss) {
  model_->on_connection_lost(loss);
  // CiA 301 §7.5.2.32: what a communication error does to the NMT state.
  if (error_behaviour_ == 0 && state_ == NmtState::operational) {
    enter(NmtState::pre_operational);
  } else if (error_behaviour_ == 2) {
    enter(NmtState::stopped);
  }
}

void Drive::on_rpdo_length_error(std::uint8_t number, bool too_long) {
  const PdoRules& rules = model_->traits().pdo;
  if (rules.length_errors || rules.exact_length[number - 1U] != 0) {
    const std::uint16_t code = too_long && rules.length_errors ? 0x8220 : 0x8210;
    emergency_.raise(ErrorSource::rpdo_length, {code, kCommunicationError, {}}, number);
  }
}

void Drive::on_tick(canopen::Duration passed) {
  if (!powered() || state_ == NmtState::initialising) {
    return;
  }
  motor_.step(passed);
  model_->step(passed);
  if (state_ == NmtState::operational) {
    pdos_.look_for_changes();
  }
}

}  // namespace simulator
