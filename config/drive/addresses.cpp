#include <algorithm>
#include <array>
#include <string_view>

#include "config/address_map.h"
#include "config/drive/builder.h"

namespace config {
namespace {

struct FixedPlace {
  std::string_view name;
  std::uint16_t address;
};

// The same in every profile, so that one screen fits all drives.
constexpr std::array<FixedPlace, 17> kRegisters{{{"status_word", 0},
                                                 {"fault_code", 1},
                                                 {"output_frequency", 2},
                                                 {"output_current", 3},
                                                 {"motor_speed", 4},
                                                 {"output_torque", 5},
                                                 {"output_power", 6},
                                                 {"output_voltage", 7},
                                                 {"input_voltage", 8},
                                                 {"dc_bus_voltage", 9},
                                                 {"module_temperature", 10},
                                                 {"actual_velocity", 11},
                                                 {"velocity_demand", 12},
                                                 {"control_command", 100},
                                                 {"frequency_command", 101},
                                                 {"torque_command", 102},
                                                 {"target_velocity", 103}}};
constexpr std::array<FixedPlace, 6> kBits{
    {{"running", 0}, {"reverse", 1}, {"fault", 2}, {"warning", 3}, {"ready", 4}, {"remote", 5}}};

std::optional<std::uint16_t> fixed_address(const Signal& signal, ModbusKind kind) {
  const auto find = [&signal](const auto& places) -> std::optional<std::uint16_t> {
    const auto found =
        std::find_if(places.begin(), places.end(), [&](const FixedPlace& p) { return p.name == signal.name; });
    return found == places.end() ? std::nullopt : std::optional(found->address);
  };
  return kind == ModbusKind::bit ? find(kBits) : find(kRegisters);
}

bool overlaps(const ModbusPlace& a, const ModbusPlace& b) {
  return a.kind == b.kind && a.address < b.address + b.count && b.address < a.address + a.count;
}

class Placer {
 public:
  explicit Placer(DriveDraft& draft) : draft_(draft) {}

  void run() {
    for (SignalDraft& signal : draft_.signals) {
      place(signal);
    }
    for (SignalDraft* const signal : missing_) {
      const auto free = free_for(signal->signal.modbus);
      error(signal->said->place, *signal, "needs an address for Modbus; " + shown(free));
      // The next one shall hear of another.
      signal->signal.modbus.address = free.value_or(0);
      placed_.push_back(signal);
    }
  }

 private:
  /// At what decides over the place: the last of them that the site says, else the last that is there.
  void error(const SignalDraft& signal, const std::string& text) {
    Place place = signal.said->place;
    for (const auto* const key : {"type", "as", "address"}) {
      if (const Node* const value = signal.said->table->find(key); value != nullptr) {
        place = in_the_site(value->place, place);
      }
    }
    error(place, signal, text);
  }
  void error(Place place, const SignalDraft& signal, const std::string& text) {
    draft_.error(place, "signal \"" + signal.signal.name + "\" " + text);
  }

  static std::string shown(std::optional<std::uint16_t> free) {
    return free.has_value() ? std::to_string(*free) + " is free" : "none is free";
  }

  static ModbusPlace shape_of(const SignalDraft& signal) {
    const canopen::DataType type = signal.signal.type;
    if (type == canopen::DataType::boolean) {
      return {.kind = ModbusKind::bit, .count = 1};
    }
    if (signal.said->keys.as_float) {
      return {.kind = ModbusKind::holding, .count = 2, .as_float = true};
    }
    const unsigned registers = (canopen::byte_length(type) + 1) / 2;
    return {.kind = ModbusKind::holding, .count = static_cast<std::uint16_t>(registers)};
  }

  /// The first address from 200 on that nothing placed so far takes.
  std::optional<std::uint16_t> free_for(ModbusPlace place) {
    for (unsigned address = kCommonAddresses; address + place.count <= kAddresses; address += place.count) {
      place.address = static_cast<std::uint16_t>(address);
      const bool diagnostics = address < kDiagnosticsEnd && address + place.count > kDiagnosticsBegin;
      if (!diagnostics && std::none_of(placed_.begin(), placed_.end(),
                                       [&](const auto* p) { return overlaps(p->signal.modbus, place); })) {
        return place.address;
      }
    }
    return std::nullopt;
  }

  void place(SignalDraft& signal) {
    ModbusPlace& place = signal.signal.modbus;
    place = shape_of(signal);
    if (place.kind == ModbusKind::bit && signal.said->keys.as_float) {
      error(signal, "is a boolean and takes no as = \"float\"");
    }
    const auto fixed = fixed_address(signal.signal, place.kind);
    const auto stated = signal.said->keys.address;
    if (!stated.has_value() && !fixed.has_value()) {
      const bool on_modbus = draft_.drive.unit.has_value() || draft_.drive.flat.has_value();
      if (on_modbus && signal.said->table->find("address") == nullptr) {
        missing_.push_back(&signal);
      }
      // Without any unit an address is nobody's need.
      if (!on_modbus) {
        place = {};
      }
      return;
    }
    place.address = stated.has_value() ? static_cast<std::uint16_t>(*stated) : *fixed;
    if (!check(signal, fixed)) {
      return;
    }
    const auto same =
        std::find_if(placed_.begin(), placed_.end(), [&](const auto* p) { return overlaps(p->signal.modbus, place); });
    if (same != placed_.end()) {
      const Place at = in_the_site(place_of(*signal.said, "address"), place_of(*(*same)->said, "address"));
      error(at, signal,
            "overlaps \"" + (*same)->signal.name + "\" at Modbus address " +
                std::to_string((*same)->signal.modbus.address) + "; " + shown(free_for(place)));
      return;
    }
    placed_.push_back(&signal);
  }

  /// True where it may be there.
  bool check(const SignalDraft& signal, std::optional<std::uint16_t> fixed) {
    const ModbusPlace& place = signal.signal.modbus;
    const unsigned past = place.address + unsigned{place.count};
    const std::string at = "Modbus address " + std::to_string(place.address);
    if (place.address < kCommonAddresses && (place.address != fixed || place.count > 1)) {
      error(signal, place.address == fixed
                        ? "takes more than one register and cannot stay at its fixed " + at +
                              "; give it an even address from 200 on"
                        : "cannot have " + at + ": 0..199 have the same meaning for every drive; use 200..999 or " +
                              "1100..65535");
    } else if (place.address < kDiagnosticsEnd && past > kDiagnosticsBegin) {
      error(signal, "cannot have " + at + ": 1000..1099 are the diagnostics; use 200..999 or 1100..65535");
    } else if (past > kAddresses) {
      error(signal, "reaches beyond Modbus address 65535");
    } else if (place.count > 1 && place.address % 2 != 0) {
      error(signal, "takes " + std::to_string(place.count) + " registers and needs an even address, not " +
                        std::to_string(place.address));
    } else {
      return true;
    }
    return false;
  }

  DriveDraft& draft_;
  std::vector<const SignalDraft*> placed_;
  std::vector<SignalDraft*> missing_;
};

}  // namespace

void place_signals(DriveDraft& draft) {
  Placer(draft).run();
}

}  // namespace config
