#include "bridges/trace/object_words.h"

#include <algorithm>
#include <string_view>

#include "bridges/alarms/fault_naming.h"
#include "bridges/mqtt/value_text.h"
#include "bridges/trace/communication_words.h"
#include "canopen/hex.h"

namespace trace {
namespace {

using canopen::hex;
using config::Drive;
using config::Signal;

bool is_printable(std::span<const std::uint8_t> bytes) {
  return std::ranges::all_of(bytes, [](std::uint8_t byte) { return byte >= 0x20 && byte < 0x7F; });
}

// What stands in the value of a text: some devices fill it up with zeros.
std::span<const std::uint8_t> without_end(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty() && bytes.back() == 0) {
    bytes = bytes.first(bytes.size() - 1);
  }
  return bytes;
}

std::string number_words(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) {
    value = value << 8U | bytes[i - 1];
  }
  return "0x" + hex(value, static_cast<unsigned>(2 * bytes.size())) + " (" + std::to_string(value) + ")";
}

bool is_true(const config::Derived& derived, const Signal& word, canopen::Raw raw) {
  if (derived.negative) {
    return canopen::to_number(word.type, raw) < 0;
  }
  return std::ranges::find(derived.values, raw & derived.mask) != derived.values.end();
}

// Nothing is derived from most words.
std::string word_value(const Drive& drive, const Signal& signal, canopen::Raw raw) {
  const auto position = static_cast<std::size_t>(&signal - drive.signals.data());
  bool has_bits = false;
  std::string set;
  for (const Signal& other : drive.signals) {
    if (other.derived && other.derived->from == position && !other.derived->negative) {
      has_bits = true;
      if (is_true(*other.derived, signal, raw)) {
        set.append(set.empty() ? "" : ", ").append(other.name);
      }
    }
  }
  // Nobody reads the bits of a control word in decimal digits.
  has_bits = has_bits || signal.name == "control_command";
  if (!has_bits || !signal.values.empty() || canopen::is_real(signal.type) || signal.scale != 1.0) {
    return {};
  }
  const unsigned digits = 2 * canopen::byte_length(signal.type);
  const canopen::Raw cut = digits >= 16 ? raw : raw & ((canopen::Raw{1} << 4 * digits) - 1);
  return "0x" + hex(cut, digits) + (set.empty() ? "" : " (" + set + ")");
}

}  // namespace

std::string bytes_text(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += (text.empty() ? "" : " ") + hex(byte, 2);
  }
  return text.empty() ? "no data" : text;
}

const Signal* find_signal(const Drive& drive, canopen::ObjectAddress object, PdoWay way) {
  const Signal* found = nullptr;
  for (const Signal& signal : drive.signals) {
    if (signal.derived || signal.object != object) {
      continue;
    }
    if (way == PdoWay::receive ? config::writable(signal.access) : config::readable(signal.access)) {
      return &signal;
    }
    found = found == nullptr ? &signal : found;
  }
  return found;
}

std::string signal_value(const Drive& drive, const Signal& signal, canopen::Raw raw) {
  std::string text = word_value(drive, signal, raw);
  if (!text.empty()) {
    return text;
  }
  const auto position = static_cast<process::SignalId>(&signal - drive.signals.data());
  if (raw != 0 && drive.faults.fault_code == std::size_t{position}) {
    const config::FaultText named =
        alarms::name_fault_code(drive.faults, drive.node.emcy, raw, config::Severity::fault);
    return mqtt::integer_text(signal.type, raw) + " (" + named.text + ")";
  }
  const mqtt::Shape shape = mqtt::shape_of(drive, position);
  if (!mqtt::append_value(text, signal, shape, raw)) {
    return "no number";
  }
  if (shape == mqtt::Shape::name) {
    const std::string number = "(" + mqtt::integer_text(signal.type, raw) + ")";
    return text.ends_with(number) ? text : text + " " + number;
  }
  return signal.unit.empty() ? text : text + " " + signal.unit;
}

std::string object_name(const Drive* drive, canopen::ObjectAddress object, PdoWay way) {
  const Signal* const signal = drive == nullptr ? nullptr : find_signal(*drive, object, way);
  const std::string name = signal != nullptr ? signal->name : communication_name(object);
  return to_string(object) + (name.empty() ? "" : " " + name);
}

std::string object_value(const Drive* drive, canopen::ObjectAddress object, PdoWay way,
                         std::span<const std::uint8_t> kept, std::size_t bytes) {
  if (kept.size() < bytes) {
    return "a value of " + std::to_string(bytes) + " bytes";
  }
  const Signal* const signal = drive == nullptr ? nullptr : find_signal(*drive, object, way);
  if (signal != nullptr) {
    const auto raw = canopen::decode_raw(signal->type, kept);
    return raw ? signal_value(*drive, *signal, *raw) : bytes_text(kept) + ", too short for its type";
  }
  if (std::string words = communication_value(object, kept); !words.empty()) {
    return words;
  }
  const auto text = without_end(kept);
  constexpr std::size_t kNumber = 4;
  const bool is_name = object.index >= 0x1008 && object.index <= 0x100A;
  if (!text.empty() && (is_name || kept.size() > kNumber) && is_printable(text)) {
    return "\"" + std::string(text.begin(), text.end()) + "\"";
  }
  if (kept.size() > kNumber) {
    constexpr std::size_t kShown = 16;
    return "a value of " + std::to_string(bytes) + " bytes" + (bytes <= kShown ? ": " + bytes_text(kept) : "");
  }
  return kept.empty() ? "no data" : number_words(kept);
}

}  // namespace trace
