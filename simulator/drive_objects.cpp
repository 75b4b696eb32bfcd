// The communication objects a drive has whatever its kind, and its description.
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "simulator/drive.h"

namespace simulator {
namespace {

std::string_view to_string(MotorState state) {
  switch (state) {
    case MotorState::running:
      return "running";
    case MotorState::stopping:
      return "stopping";
    case MotorState::coasting:
      return "coasting";
    case MotorState::stopped:
      break;
  }
  return "stopped";
}

std::string_view on_or_off(bool on) {
  return on ? "on" : "off";
}

std::string decimal(double value, int places) {
  std::array<char, 32> text{};
  const int length = std::snprintf(text.data(), text.size(), "%.*f", places, value == 0.0 ? 0.0 : value);
  return {text.data(), static_cast<std::size_t>(length)};
}

std::string hex(unsigned value) {
  std::array<char, 16> text{};
  const int length = std::snprintf(text.data(), text.size(), "0x%04X", value);
  return {text.data(), static_cast<std::size_t>(length)};
}

void append(std::string& line, std::string_view name, std::string_view value) {
  if (!line.empty()) {
    line += ' ';
  }
  line.append(name).append("=").append(value);
}

}  // namespace

void Drive::define_communication_objects() {
  const Traits& traits = model_->traits();
  dictionary_.add_constant({0x1000, 0}, 4, traits.device_type);
  emergency_.define(dictionary_, traits);
  error_control_.define(dictionary_, traits.node_guarding);
  heartbeat_consumer_.define(dictionary_);
  pdos_.define(dictionary_);
  if (!traits.device_name.empty()) {
    dictionary_.add_text({0x1008, 0}, traits.device_name);
  }
  if (traits.identity) {
    dictionary_.add_constant({0x1018, 0}, 1, 4);
    for (std::size_t i = 0; i < traits.identity->size(); ++i) {
      dictionary_.add_constant({0x1018, static_cast<std::uint8_t>(i + 1)}, 4, (*traits.identity)[i]);
    }
    if (options_.serial) {
      dictionary_.add_constant({0x1018, 4}, 4, *options_.serial);
    }
  }
  if (traits.sync_objects) {
    Object cob_id;
    cob_id.size = 4;
    cob_id.read = [this] { return sync_cob_id_; };
    cob_id.write = [this](std::uint32_t value) {
      if (value == 0 || value > canopen::kMaxCobId) {
        return Abort::invalid_value;  // It produces no SYNC (bit 30) and knows no 29-bit identifiers.
      }
      sync_cob_id_ = value;
      return Abort::none;
    };
    dictionary_.add({0x1005, 0}, std::move(cob_id));
  }
  if (traits.sync_counter) {
    Object overflow;
    overflow.size = 1;
    overflow.read = [this] { return sync_overflow_; };
    overflow.write = [this](std::uint32_t value) {
      if (value == 1 || value > 240) {
        return Abort::invalid_value;  // CiA 301 §7.5.2.22: 0, 2..240
      }
      sync_overflow_ = static_cast<std::uint8_t>(value);
      return Abort::none;
    };
    dictionary_.add({0x1019, 0}, std::move(overflow));
  }
  if (traits.error_behaviour) {
    dictionary_.add_constant({0x1029, 0}, 1, 1);
    Object behaviour;
    behaviour.size = 1;
    behaviour.read = [this] { return error_behaviour_; };
    behaviour.write = [this](std::uint32_t value) {
      if (value > 2) {
        return Abort::invalid_value;
      }
      error_behaviour_ = static_cast<std::uint8_t>(value);
      return Abort::none;
    };
    dictionary_.add({0x1029, 1}, std::move(behaviour));
  }
}

// No drive has it, and no standard names an object here: so that somebody with only an SDO client can see a fault.
void Drive::define_trouble_object() {
  Object trouble;
  trouble.read = [this] { return std::uint32_t{model_->fault()}; };
  trouble.write = [this](std::uint32_t code) {
    if (code == 0) {
      clear_faults();
    } else {
      fault(static_cast<std::uint16_t>(code));
    }
    return Abort::none;
  };
  dictionary_.add(kTroubleObject, std::move(trouble));
}

std::string Drive::describe() {
  std::string line;
  append(line, "node", std::to_string(node_));
  append(line, "kind", kind());
  append(line, "power", on_or_off(powered()));
  append(line, "nmt", simulator::to_string(state_));
  append(line, "motor", to_string(motor_.state()));
  append(line, "direction", motor_.reverse() ? "reverse" : "forward");
  append(line, "frequency", decimal(std::abs(motor_.output_hz()), 2));
  append(line, "target", decimal(motor_.target_hz(), 2));
  append(line, "rpm", decimal(motor_.shaft_rpm(), 0));
  append(line, "current", decimal(motor_.current_a(), 1));
  append(line, "torque", decimal(motor_.torque_percent(), 1));
  append(line, "dc_bus", decimal(motor_.dc_bus_v(), 1));
  append(line, "fault", hex(model_->fault()));
  append(line, "warning", hex(model_->warning()));
  append(line, "mute", on_or_off(misbehaviour_.mute));
  append(line, "unplugged", on_or_off(misbehaviour_.unplugged));
  append(line, "nmt_commands", std::to_string(record_.nmt_command_count));
  append(line, "sdo_reads", std::to_string(Record::total(record_.sdo_reads)));
  append(line, "sdo_writes", std::to_string(Record::total(record_.sdo_writes)));
  append(line, "sdo_refusals", std::to_string(Record::total(record_.sdo_refusals)));
  append(line, "rpdos", std::to_string(record_.rpdo_total()));
  append(line, "tpdos", std::to_string(record_.tpdos));
  append(line, "heartbeats", std::to_string(record_.heartbeats));
  append(line, "boot_ups", std::to_string(record_.boot_ups));
  append(line, "emergencies", std::to_string(record_.emergencies));
  append(line, "syncs", std::to_string(record_.syncs));
  append(line, "run_commands", std::to_string(record_.run_commands));
  append(line, "eeprom_writes", std::to_string(record_.eeprom_writes));
  return line;
}

}  // namespace simulator
