#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>

#include "simulator/object_dictionary.h"
#include "simulator/traits.h"

namespace simulator {

/// What an error comes from; each is raised and cleared on its own.
enum class ErrorSource : std::uint8_t { drive, heartbeat, life_guarding, rpdo_length, rpdo_deadline, sync_length };

/// EMCY producer: 0x1001, and where the drive has them 0x1003 and 0x1014. Keeps account of the errors still active.
class Emergency {
 public:
  using Send = std::function<void(std::uint32_t cob_id, const EmergencyMessage&)>;

  Emergency(std::uint8_t node, Send send);

  /// Forgets the history and enables the EMCY; active errors stay. `stored`: what 0x1014 holds instead.
  void restore_defaults(std::optional<std::uint32_t> stored = std::nullopt);
  /// 0x1014 holds this from now on; without a value 0x80 + node.
  void set_stored_id(std::optional<std::uint32_t> stored) { cob_id_ = stored.value_or(0x80U + node_); }
  /// Nothing is wrong and nothing is said about it: after a power-on.
  void forget_errors() { active_.clear(); }
  /// The communication starts anew; errors of the drive itself stay.
  void forget_communication_errors();
  void define(ObjectDictionary& dictionary, const Traits& traits);

  /// Reports an error unless this source has reported the very same. `message.error_register` holds the bits of this
  /// source; the frame carries those of all active ones. `number` tells sources of one sort apart.
  void raise(ErrorSource source, EmergencyMessage message, std::uint8_t number = 0);
  /// Reports that it is gone (code 0x0000), if it was there.
  void clear(ErrorSource source, std::uint8_t number = 0);
  [[nodiscard]] bool active(ErrorSource source, std::uint8_t number = 0) const;
  [[nodiscard]] std::uint8_t error_register() const;

 private:
  static constexpr std::size_t kHistory = 8;
  static constexpr std::uint32_t kDisabled = 0x80000000U;  ///< bit 31 of 0x1014

  void define_history(ObjectDictionary& dictionary);
  void send(EmergencyMessage message);
  Abort set_cob_id(std::uint32_t value);

  std::uint8_t node_;
  Send send_;
  bool counts_sources_ = false;
  std::uint32_t cob_id_ = 0;
  std::map<std::pair<ErrorSource, std::uint8_t>, EmergencyMessage> active_;
  std::deque<std::uint32_t> history_;  ///< newest first
};

}  // namespace simulator
