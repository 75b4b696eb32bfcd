#include <string_view>

#include "daemon/manual/manual.h"

namespace gateway::manual {
namespace {

constexpr std::string_view kTop = R"bash(# bash completion of canopen-gateway
_canopen_gateway() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} path= skip= i
  local -a global=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    if [ -n "$skip" ]; then skip=; continue; fi
    case ${COMP_WORDS[i]} in
      --config|--profile-dir) global+=("${COMP_WORDS[i]}" "${COMP_WORDS[i+1]}"); skip=1 ;;
      -*) ;;
      *) path+=" ${COMP_WORDS[i]}" ;;
    esac
  done
  case $before in
    --config|--control) mapfile -t COMPREPLY < <(compgen -f -- "$word"); return ;;
    --profile-dir) mapfile -t COMPREPLY < <(compgen -d -- "$word"); return ;;
    --interface) mapfile -t COMPREPLY < <(compgen -W "$(ls /sys/class/net 2>/dev/null)" -- "$word"); return ;;
    --format) mapfile -t COMPREPLY < <(compgen -W "table json csv markdown" -- "$word"); return ;;
  esac
  local words=
  case $path in
)bash";

constexpr std::string_view kBottom = R"bash(  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -F _canopen_gateway canopen-gateway
)bash";

constexpr std::string_view kDrives =
    R"bash( $(canopen-gateway "${global[@]}" map --format csv 2>/dev/null | tail -n +2 | cut -d, -f1 | sort -u))bash";

bool takes_drive_first(const Command& command) {
  for (const Option& option : command.options) {
    if (option.flag.empty()) {
      return option.name == "DRIVE";
    }
  }
  return false;
}  // namespace

void add_words(const Command& command, const std::string& path, const std::string& global, std::string& out) {
  std::string words;
  for (const Command& below : command.below) {
    words += (words.empty() ? "" : " ") + below.name;
  }
  for (const Option& option : command.options) {
    if (!option.flag.empty()) {
      words += (words.empty() ? "" : " ") + option.flag;
    }
  }
  words += global;
  out +=
      "    \"" + path + "\") words=\"" + words + (takes_drive_first(command) ? std::string(kDrives) : "") + "\" ;;\n";
  for (const Command& below : command.below) {
    add_words(below, path + " " + below.name, global, out);
  }
}

}  // namespace

std::string bash_completion(const Command& program) {
  std::string global;
  for (const Option& option : program.options) {
    global += option.flag == "--version" ? "" : " " + option.flag;
  }
  std::string out(kTop);
  Command top = program;
  std::erase_if(top.options, [](const Option& option) { return option.flag != "--version"; });
  add_words(top, "", global, out);
  out += "    *) words=\"" + global + "\" ;;\n";  // behind an argument
  out += kBottom;
  return out;
}

}  // namespace gateway::manual
