#include "simulator/console_verbs.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>

namespace simulator {
namespace {

std::optional<std::string> set_switch(bool& target, std::string_view text) {
  if (text != "on" && text != "off") {
    return expected("on or off", text);
  }
  target = text == "on";
  return std::nullopt;
}

std::optional<std::string> power(Drive& drive, Arguments arguments) {
  bool on = false;
  auto error = set_switch(on, arguments[0]);
  if (!error) {
    on ? drive.power_on() : drive.power_off();
  }
  return error;
}

std::optional<std::string> reboot(Drive& drive, Arguments arguments) {
  std::uint32_t pause = 500;
  if (!arguments.empty()) {
    const auto given = parse_number(arguments[0], 3'600'000);
    if (!given) {
      return expected("a pause of 0 to 3600000 ms", arguments[0]);
    }
    pause = *given;
  }
  drive.reboot(std::chrono::milliseconds(pause));
  return std::nullopt;
}

template <void (Drive::*action)(std::uint16_t)>
std::optional<std::string> trouble(Drive& drive, Arguments arguments) {
  const auto code = parse_number(arguments[0], 0xFFFF);
  if (!code || *code == 0) {
    return expected("a code of 1 to 0xFFFF", arguments[0]);
  }
  (drive.*action)(static_cast<std::uint16_t>(*code));
  return std::nullopt;
}

std::optional<std::string> clear(Drive& drive, Arguments /*arguments*/) {
  drive.clear_faults();
  return std::nullopt;
}

std::optional<std::string> nmt(Drive& drive, Arguments arguments) {
  for (const NmtState state : {NmtState::operational, NmtState::pre_operational, NmtState::stopped}) {
    if (arguments[0] == to_string(state)) {
      drive.go(state);
      return std::nullopt;
    }
  }
  return expected("operational, pre-operational or stopped", arguments[0]);
}

template <bool Misbehaviour::* flag>
std::optional<std::string> set_flag(Drive& drive, Arguments arguments) {
  return set_switch(drive.misbehaviour().*flag, arguments[0]);
}

/// The switch reads the other way round: `heartbeat off` sets `heartbeat_stopped`.
template <bool Misbehaviour::* flag>
std::optional<std::string> set_inverted(Drive& drive, Arguments arguments) {
  bool on = false;
  auto error = set_switch(on, arguments[0]);
  if (!error) {
    drive.misbehaviour().*flag = !on;
  }
  return error;
}

std::optional<std::string> sdo_delay(Drive& drive, Arguments arguments) {
  const auto delay = parse_number(arguments[0], 3'600'000);
  if (!delay) {
    return expected("a delay of 0 to 3600000 ms", arguments[0]);
  }
  drive.misbehaviour().sdo_delay = std::chrono::milliseconds(*delay);
  return std::nullopt;
}

std::optional<std::string> pdo_only(Drive& drive, Arguments arguments) {
  if (arguments[0] == "off") {
    drive.misbehaviour().pdo_only.reset();
    return std::nullopt;
  }
  const auto code = parse_number(arguments[0], 0xFFFFFFFF);
  if (!code || *code == 0) {
    return expected("an abort code or off", arguments[0]);
  }
  drive.misbehaviour().pdo_only = code;
  return std::nullopt;
}

std::optional<std::string> absent(Drive& drive, Arguments arguments) {
  if (arguments[0] == "none") {
    drive.misbehaviour().absent.clear();
    return std::nullopt;
  }
  const std::string_view object = arguments[0];
  const std::size_t colon = object.find(':');
  const auto index = parse_number(object.substr(0, colon), 0xFFFF);
  AbsentObject added{static_cast<std::uint16_t>(index.value_or(0)), {}};
  if (colon != std::string_view::npos) {
    // As everywhere a sub-index is written: two hexadecimal digits.
    const auto sub = parse_number("0x" + std::string(object.substr(colon + 1)), 0xFF);
    if (!sub) {
      return expected("an object like 0x2021 or 0x2021:05, or none", object);
    }
    added.sub = static_cast<std::uint8_t>(*sub);
  }
  if (!index) {
    return expected("an object like 0x2021 or 0x2021:05, or none", object);
  }
  drive.misbehaviour().absent.push_back(added);
  return std::nullopt;
}

std::optional<std::string> emcy_id(Drive& drive, Arguments arguments) {
  std::optional<std::uint32_t> stored;
  if (arguments[0] != "normal") {
    stored = parse_number(arguments[0], 0xFFFFFFFF);
    if (!stored) {
      return expected("a value of 0x1014 or normal", arguments[0]);
    }
  }
  drive.misbehaviour().emcy_id = stored;
  drive.emergency().set_stored_id(stored);
  return std::nullopt;
}

std::optional<std::string> sdo_drop(Drive& drive, Arguments arguments) {
  const auto count = parse_number(arguments[0], 1'000'000'000);
  if (!count) {
    return expected("a count of requests", arguments[0]);
  }
  drive.misbehaviour().sdo_drops_left = *count;
  return std::nullopt;
}

struct FlawName {
  std::string_view name;
  SdoFlaw flaw;
};
constexpr std::array<FlawName, 6> kFlaws{{{"none", SdoFlaw::none},
                                          {"foreign-index", SdoFlaw::foreign_index},
                                          {"foreign-sub-index", SdoFlaw::foreign_sub_index},
                                          {"wrong-toggle", SdoFlaw::wrong_toggle},
                                          {"unknown-command", SdoFlaw::unknown_command},
                                          {"abort", SdoFlaw::abort}}};

std::optional<std::string> sdo_flaw(Drive& drive, Arguments arguments) {
  const auto found =
      std::find_if(kFlaws.begin(), kFlaws.end(), [&](const FlawName& flaw) { return flaw.name == arguments[0]; });
  if (found == kFlaws.end()) {
    return expected("none, foreign-index, foreign-sub-index, wrong-toggle, unknown-command or abort", arguments[0]);
  }
  arguments = arguments.subspan(1);
  std::uint32_t code = Misbehaviour{}.abort_code;
  if (found->flaw == SdoFlaw::abort && !arguments.empty()) {
    const auto given = parse_number(arguments[0], 0xFFFFFFFF);
    if (!given) {
      return expected("an abort code", arguments[0]);
    }
    code = *given;
    arguments = arguments.subspan(1);
  }
  std::optional<std::uint32_t> count;
  if (!arguments.empty()) {
    count = parse_number(arguments[0], 1'000'000'000);
    if (!count) {
      return expected("a count of answers", arguments[0]);
    }
    arguments = arguments.subspan(1);
  }
  if (!arguments.empty()) {
    return "too much after the count: \"" + std::string(arguments[0]) + "\"";
  }
  drive.misbehaviour().sdo_flaw = found->flaw;
  drive.misbehaviour().abort_code = code;
  drive.misbehaviour().flaws_left = count;
  return std::nullopt;
}

struct LengthName {
  std::string_view name;
  std::optional<std::uint8_t> Misbehaviour::* length;
};
constexpr std::array<LengthName, 4> kLengths{{{"tpdo", &Misbehaviour::tpdo_length},
                                              {"sdo", &Misbehaviour::sdo_length},
                                              {"heartbeat", &Misbehaviour::heartbeat_length},
                                              {"emcy", &Misbehaviour::emcy_length}}};

std::optional<std::string> length(Drive& drive, Arguments arguments) {
  const auto found = std::find_if(kLengths.begin(), kLengths.end(),
                                  [&](const LengthName& candidate) { return candidate.name == arguments[0]; });
  if (found == kLengths.end()) {
    return expected("tpdo, sdo, heartbeat or emcy", arguments[0]);
  }
  if (arguments[1] == "normal") {
    (drive.misbehaviour().*(found->length)).reset();
    return std::nullopt;
  }
  const auto bytes = parse_number(arguments[1], 8);
  if (!bytes) {
    return expected("0 to 8 bytes or normal", arguments[1]);
  }
  drive.misbehaviour().*(found->length) = static_cast<std::uint8_t>(*bytes);
  return std::nullopt;
}

std::optional<std::string> behave(Drive& drive, Arguments /*arguments*/) {
  drive.misbehaviour() = {};
  return std::nullopt;
}

constexpr std::array<Verb, 23> kVerbs{{
    {"power", 1, 1, false, "on|off", "power supply", power},
    {"reboot", 0, 1, false, "[MS]", "power off and, after a pause (500 ms), on again", reboot},
    {"fault", 1, 1, true, "CODE", "trip with a fault of the drive's own table", trouble<&Drive::fault>},
    {"warning", 1, 1, true, "CODE", "warn, without tripping", trouble<&Drive::warning>},
    {"clear", 0, 0, false, "", "reset faults and warnings at the drive itself", clear},
    {"nmt", 1, 1, true, "operational|pre-operational|stopped", "change state without being told", nmt},
    {"mute", 1, 1, false, "on|off", "send nothing, still hear", set_flag<&Misbehaviour::mute>},
    {"unplug", 1, 1, false, "on|off", "neither send nor hear", set_flag<&Misbehaviour::unplugged>},
    {"heartbeat", 1, 1, false, "on|off", "heartbeats and guarding answers",
     set_inverted<&Misbehaviour::heartbeat_stopped>},
    {"toggle", 1, 1, false, "on|off", "the toggle bit of guarding answers", set_inverted<&Misbehaviour::toggle_stuck>},
    {"boot-up", 1, 1, false, "on|off", "boot-up frames", set_inverted<&Misbehaviour::boot_up_missing>},
    {"sdo-delay", 1, 1, false, "MS", "answer later; 0 at once", sdo_delay},
    {"sdo-drop", 1, 1, false, "COUNT", "leave the next requests without answer", sdo_drop},
    {"sdo-short", 1, 1, false, "on|off", "cut answers to the bytes they need", set_flag<&Misbehaviour::sdo_short>},
    {"sdo-flaw", 1, 3, false, "none|foreign-index|foreign-sub-index|wrong-toggle|unknown-command|abort [CODE] [COUNT]",
     "spoil answers: all, or COUNT of them", sdo_flaw},
    {"pdo-only", 1, 1, false, "CODE|off", "refuse SDO writes to objects of an RPDO with this abort code", pdo_only},
    {"local", 1, 1, false, "on|off", "controlled at its keypad: what the bus commands has no effect",
     set_flag<&Misbehaviour::local>},
    {"absent", 1, 1, false, "INDEX[:SUB]|none", "deny to have an object, and one more each time", absent},
    {"emcy-id", 1, 1, false, "VALUE|normal", "0x1014 holds this, after each start too; bit 31: no emergencies",
     emcy_id},
    {"length", 2, 2, false, "tpdo|sdo|heartbeat|emcy BYTES|normal", "send frames of a wrong length", length},
    {"behave", 0, 0, false, "", "end all misbehaviour; faults and power stay as they are", behave},
    {"show", 0, 0, false, "", "state and counters in one line", nullptr},
    {"help", 0, 0, false, "", "this text; also without NODE", nullptr},
}};

}  // namespace

std::span<const Verb> console_verbs() {
  return kVerbs;
}

const Verb* find_console_verb(std::string_view name) {
  const auto found = std::find_if(kVerbs.begin(), kVerbs.end(), [&](const Verb& verb) { return verb.name == name; });
  return found == kVerbs.end() ? nullptr : &*found;
}

std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kBlank = " \t\r\n";
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(kBlank);
    if (begin == std::string_view::npos) {
      return words;
    }
    const std::size_t end = std::min(line.find_first_of(kBlank, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

std::optional<std::uint32_t> parse_number(std::string_view text, std::uint32_t greatest) {
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    base = 16;
    text.remove_prefix(2);
  }
  std::uint32_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, base);
  if (error != std::errc{} || stop != end || value > greatest) {
    return std::nullopt;
  }
  return value;
}

std::string expected(std::string_view what, std::string_view got) {
  return std::string(what) + " expected, not \"" + std::string(got) + "\"";
}

}  // namespace simulator
