#include "simulator/pdos.h"

#include <algorithm>
#include <utility>

#include "simulator/pdo_objects.h"

namespace simulator {
namespace {

/// COB-IDs of the predefined connection set (CiA 301 §7.3.5); PDO5 and above have none.
std::uint32_t predefined(std::uint8_t number, std::uint8_t node, bool transmit) {
  if (number > 4) {
    return kPdoDisabled;
  }
  return (transmit ? 0x180U : 0x200U) + 0x100U * (number - 1U) + node;
}

PdoSettings settings_of(const PdoDefaults& defaults, std::uint8_t number, std::uint8_t node, bool transmit) {
  PdoSettings settings;
  settings.cob_id = predefined(number, node, transmit) | (defaults.enabled ? 0U : kPdoDisabled);
  settings.type = defaults.type;
  settings.inhibit = defaults.inhibit;
  settings.event = defaults.event;
  settings.count = static_cast<std::uint8_t>(defaults.map.size());
  std::copy(defaults.map.begin(), defaults.map.end(), settings.map.begin());
  return settings;
}

}  // namespace

Pdos::Pdos(PdoContext context) : context_(std::move(context)) {}

void Pdos::start(const PdoRules& rules) {
  context_.rules = rules;
  transmit_.clear();
  receive_.clear();
  for (std::size_t i = 0; i < rules.transmit.size(); ++i) {
    transmit_.push_back(std::make_unique<TransmitPdo>(static_cast<std::uint8_t>(i + 1), context_));
  }
  for (std::size_t i = 0; i < rules.receive.size(); ++i) {
    receive_.push_back(std::make_unique<ReceivePdo>(static_cast<std::uint8_t>(i + 1), context_));
  }
  restore_defaults();
}

void Pdos::restore_defaults() {
  for (std::size_t i = 0; i < transmit_.size(); ++i) {
    transmit_[i]->stop();
    transmit_[i]->settings() =
        settings_of(context_.rules.transmit[i], static_cast<std::uint8_t>(i + 1), context_.node, true);
  }
  for (std::size_t i = 0; i < receive_.size(); ++i) {
    receive_[i]->stop();
    receive_[i]->settings() =
        settings_of(context_.rules.receive[i], static_cast<std::uint8_t>(i + 1), context_.node, false);
  }
}

void Pdos::define(ObjectDictionary& dictionary) {
  if (!context_.rules.objects_present) {
    return;
  }
  for (std::size_t i = 0; i < transmit_.size(); ++i) {
    TransmitPdo& pdo = *transmit_[i];
    define_pdo_objects(dictionary, context_, static_cast<std::uint8_t>(i + 1), true, pdo.settings(),
                       [&pdo] { pdo.apply_settings(); });
  }
  for (std::size_t i = 0; i < receive_.size(); ++i) {
    ReceivePdo& pdo = *receive_[i];
    define_pdo_objects(dictionary, context_, static_cast<std::uint8_t>(i + 1), false, pdo.settings(),
                       [&pdo] { pdo.apply_settings(); });
  }
}

void Pdos::enter_operational() {
  for (const auto& pdo : transmit_) {
    pdo->start();
  }
}

void Pdos::leave_operational() {
  for (const auto& pdo : transmit_) {
    pdo->stop();
  }
  for (const auto& pdo : receive_) {
    pdo->stop();
  }
}

bool Pdos::on_frame(const canopen::Frame& frame) {
  bool mine = false;
  if (frame.remote) {
    for (const auto& pdo : transmit_) {
      if (pdo->settings().enabled() && pdo->settings().id() == frame.id) {
        pdo->on_remote_request();
        mine = true;
      }
    }
    return mine;
  }
  for (const auto& pdo : receive_) {
    if (!pdo->settings().enabled() || pdo->settings().id() != frame.id) {
      continue;
    }
    mine = true;
    if (pdo->on_frame(frame) && pdo->number() <= transmit_.size()) {
      transmit_[pdo->number() - 1U]->on_rpdo();
    }
  }
  if (mine) {
    look_for_changes();
  }
  return mine;
}

bool Pdos::receives(Address address) const {
  return std::any_of(receive_.begin(), receive_.end(), [address](const std::unique_ptr<ReceivePdo>& pdo) {
    const PdoSettings& settings = pdo->settings();
    return settings.enabled() &&
           std::any_of(settings.map.begin(), settings.map.begin() + settings.count,
                       [address](std::uint32_t entry) { return map_entry(entry).address == address; });
  });
}

void Pdos::on_sync(std::optional<std::uint8_t> counter) {
  // CiA 301 §7.2.2.3: synchronous RPDOs of the last cycle take effect, then TPDOs are sampled.
  for (const auto& pdo : receive_) {
    if (pdo->on_sync() && pdo->number() <= transmit_.size()) {
      transmit_[pdo->number() - 1U]->on_rpdo();
    }
  }
  for (const auto& pdo : transmit_) {
    pdo->on_sync(counter);
  }
}

void Pdos::look_for_changes() {
  for (const auto& pdo : transmit_) {
    pdo->look_for_change();
  }
}

}  // namespace simulator
