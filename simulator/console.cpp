#include "simulator/console.h"

#include <algorithm>
#include <iterator>

#include "simulator/console_verbs.h"

namespace simulator {
namespace {

std::string failure(std::string_view text) {
  return "error: " + std::string(text);
}

std::string usage_of(const Verb& verb) {
  return std::string("NODE ").append(verb.name).append(verb.usage.empty() ? "" : " ").append(verb.usage);
}

}  // namespace

bool Console::add(Drive& drive) {
  return drives_.emplace(drive.node(), &drive).second;
}

std::string Console::help() {
  std::string text =
      "NODE VERB [ARGUMENT...], where NODE is a number or `all` and numbers may be hexadecimal (0x...)\n"
      "list: one line for every drive\n";
  for (const Verb& verb : console_verbs()) {
    text.append(usage_of(verb)).append(": ").append(verb.help).append("\n");
  }
  text.pop_back();
  return text;
}

std::string Console::execute(std::string_view line) {
  const std::vector<std::string_view> words = words_of(line);
  if (words.empty() || words[0].starts_with('#')) {
    return {};
  }
  if (words[0] == "help") {
    return help();
  }
  if (words[0] == "list") {
    return show(drives_of("all"));
  }
  const std::vector<Drive*> drives = drives_of(words[0]);
  if (drives.empty()) {
    return failure("no drive \"" + std::string(words[0]) + "\"; there are " + nodes() + ", or `all`");
  }
  const Verb* const verb = words.size() < 2 ? nullptr : find_console_verb(words[1]);
  if (verb == nullptr) {
    const std::string what = words.size() < 2 ? "what to do is missing" : expected("a verb", words[1]);
    return failure(what + "; `help` lists the verbs");
  }
  const Arguments arguments = Arguments(words).subspan(2);
  if (arguments.size() < verb->least || arguments.size() > verb->most) {
    return failure("it goes `" + usage_of(*verb) + "`");
  }
  if (verb->handler == nullptr) {
    return verb->name == "show" ? show(drives) : help();
  }
  // Before anything is done: an order to `all` is carried out for all or for none.
  for (const Drive* const drive : drives) {
    if (verb->needs_power && !drive->powered()) {
      return failure("node " + std::to_string(drive->node()) + " has no power; `power on` first");
    }
  }
  for (Drive* const drive : drives) {
    if (const auto error = verb->handler(*drive, arguments)) {
      return failure("node " + std::to_string(drive->node()) + " " + std::string(verb->name) + ": " + *error);
    }
  }
  return "ok";
}

std::vector<Drive*> Console::drives_of(std::string_view word) const {
  std::vector<Drive*> drives;
  if (word == "all") {
    std::transform(drives_.begin(), drives_.end(), std::back_inserter(drives),
                   [](const auto& entry) { return entry.second; });
  } else if (const auto node = parse_number(word, 127)) {
    if (const auto found = drives_.find(static_cast<std::uint8_t>(*node)); found != drives_.end()) {
      drives.push_back(found->second);
    }
  }
  return drives;
}

std::string Console::nodes() const {
  std::string list;
  for (const auto& [node, drive] : drives_) {
    list.append(list.empty() ? "" : ", ").append(std::to_string(node));
  }
  return list.empty() ? "none" : list;
}

std::string Console::show(const std::vector<Drive*>& drives) {
  std::string text;
  for (Drive* const drive : drives) {
    text.append(text.empty() ? "" : "\n").append(drive->describe());
  }
  return text.empty() ? "no drives" : text;
}

}  // namespace simulator
