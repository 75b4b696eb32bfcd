#include "simulator/emergency.h"

#include <utility>

namespace simulator {

Emergency::Emergency(std::uint8_t node, Send send) : node_(node), send_(std::move(send)) {
  restore_defaults();
}

void Emergency::restore_defaults(std::optional<std::uint32_t> stored) {
  history_.clear();
  set_stored_id(stored);
}

void Emergency::forget_communication_errors() {
  std::erase_if(active_, [](const auto& error) { return error.first.first != ErrorSource::drive; });
}

Abort Emergency::set_cob_id(std::uint32_t value) {
  // CiA 301 §7.5.2.17: only bit 31 may change while the EMCY is enabled.
  if ((cob_id_ & kDisabled) == 0 && (value & ~kDisabled) != cob_id_) {
    return Abort::invalid_value;
  }
  cob_id_ = value;
  return Abort::none;
}

void Emergency::define(ObjectDictionary& dictionary, const Traits& traits) {
  counts_sources_ = traits.emergency_counts_sources;
  dictionary.add_reading({0x1001, 0}, 1, [this] { return error_register(); });
  if (traits.emergency_objects) {
    Object cob_id;
    cob_id.size = 4;
    cob_id.read = [this] { return cob_id_; };
    cob_id.write = [this](std::uint32_t value) { return set_cob_id(value); };
    dictionary.add({0x1014, 0}, std::move(cob_id));
  }
  if (traits.error_history) {
    define_history(dictionary);
  }
}

void Emergency::define_history(ObjectDictionary& dictionary) {
  Object count;
  count.size = 1;
  count.read = [this] { return static_cast<std::uint32_t>(history_.size()); };
  count.write = [this](std::uint32_t value) {
    // CiA 301 §7.5.2.4: writing 0 empties the history, nothing else may be written.
    if (value != 0) {
      return Abort::invalid_value;
    }
    history_.clear();
    return Abort::none;
  };
  dictionary.add({0x1003, 0}, std::move(count));
  for (std::size_t i = 0; i < kHistory; ++i) {
    const Address address{0x1003, static_cast<std::uint8_t>(i + 1)};
    Object& entry = dictionary.add_reading(address, 4, [this, i] { return i < history_.size() ? history_[i] : 0U; });
    entry.present = [this, i] { return i < history_.size(); };
  }
}

void Emergency::raise(ErrorSource source, EmergencyMessage message, std::uint8_t number) {
  const auto [place, added] = active_.try_emplace({source, number}, message);
  if (!added) {
    if (place->second == message) {
      return;
    }
    place->second = message;
  }
  history_.push_front(message.code);
  if (history_.size() > kHistory) {
    history_.pop_back();
  }
  send(message);
}

void Emergency::clear(ErrorSource source, std::uint8_t number) {
  if (active_.erase({source, number}) == 0) {
    return;
  }
  EmergencyMessage message;
  if (counts_sources_) {
    message.vendor[0] = static_cast<std::uint8_t>(active_.size());
  }
  send(message);
}

bool Emergency::active(ErrorSource source, std::uint8_t number) const {
  return active_.contains({source, number});
}

std::uint8_t Emergency::error_register() const {
  unsigned bits = 0;
  for (const auto& [source, message] : active_) {
    bits |= message.error_register;
  }
  return static_cast<std::uint8_t>(bits);
}

void Emergency::send(EmergencyMessage message) {
  message.error_register = error_register();
  if ((cob_id_ & kDisabled) == 0) {
    send_(cob_id_ & 0x7FFU, message);
  }
}

}  // namespace simulator
