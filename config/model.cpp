#include "config/model.h"

#include <algorithm>

namespace config {

std::optional<std::size_t> Drive::find(std::string_view signal_name) const noexcept {
  const auto found =
      std::find_if(signals.begin(), signals.end(), [signal_name](const Signal& s) { return s.name == signal_name; });
  if (found == signals.end()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - signals.begin());
}

std::string to_text(const Source& source) {
  const std::string number = std::to_string(source.number);
  return source.kind == SourceKind::sdo ? "sdo" : (source.kind == SourceKind::tpdo ? "tpdo" : "rpdo") + number;
}

std::string_view to_text(Access access) noexcept {
  return access == Access::read ? "read" : access == Access::write ? "write" : "read-write";
}

bool is_momentary(const Signal& signal, canopen::Raw raw) noexcept {
  return (raw & signal.momentary_mask) != 0 ||
         std::find(signal.momentary.begin(), signal.momentary.end(), raw) != signal.momentary.end();
}

const FaultText* find_emcy_text(const FaultRules& rules, std::uint16_t code) noexcept {
  // Within a class the low byte, then the low digit of the high byte are the finer distinctions.
  for (const unsigned mask : {0xFFFFU, 0xFF00U, 0xF000U}) {
    const auto found = rules.emcy_texts.find(static_cast<std::uint16_t>(code & mask));
    if (found != rules.emcy_texts.end()) {
      return &found->second;
    }
  }
  return nullptr;
}

}  // namespace config
