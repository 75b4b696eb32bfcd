#include "bridges/trace/log_decoder.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include "bridges/trace/line.h"
#include "config/log_interface.h"

namespace trace {
namespace {

// Beyond them bad lines are only counted: it is no log at all.
constexpr std::size_t kMostComplaints = 20;
// Of interfaces, which the log names as it likes: more than a machine has.
constexpr std::size_t kMostInterfaces = 64;

// What logs have before how people call it. All in-process buses have one interface: it tells none of them.
std::optional<std::size_t> bus_of(const config::Model& model, std::string_view interface) {
  const auto position_of = [&](auto name_of_bus) -> std::optional<std::size_t> {
    const auto found = std::ranges::find(model.buses, interface, name_of_bus);
    return found == model.buses.end() ? std::nullopt
                                      : std::optional(static_cast<std::size_t>(found - model.buses.begin()));
  };
  if (const auto logged = position_of(config::log_interface)) {
    return logged;
  }
  if (const auto named = position_of(&config::Bus::name)) {
    return named;
  }
  return model.buses.size() == 1 ? std::optional<std::size_t>(0) : std::nullopt;
}

}  // namespace

LogDecoder::LogDecoder(const config::Model& model, Filter filter, bool raw, Output output)
    : model_(model), filter_(std::move(filter)), raw_(raw), output_(std::move(output)) {}

void LogDecoder::take(std::string_view piece) {
  while (!piece.empty()) {
    const std::size_t end = std::min(piece.find('\n'), piece.size());
    // Of a line without end no more is kept than tells that it is none.
    const std::size_t room = kMaxLogLine + 1 - std::min(line_.size(), kMaxLogLine + 1);
    line_.append(piece.substr(0, std::min(end, room)));
    if (end < piece.size()) {
      take_line();
    }
    piece.remove_prefix(std::min(end + 1, piece.size()));
  }
}

void LogDecoder::finish() {
  if (!line_.empty()) {
    take_line();
  }
  if (bad_ > kMostComplaints) {
    output_.complaint(std::to_string(bad_ - kMostComplaints) + " further lines are none of a log");
  }
}

void LogDecoder::take_line() {
  std::string line = std::exchange(line_, {});
  ++number_;
  line.erase(line.find_last_not_of(" \r") + 1);
  if (line.empty()) {
    return;
  }
  const auto read = parse_candump_line(line);
  if (const auto* const none = std::get_if<NoFrame>(&read)) {
    complain_of(none->why);
  } else {
    show(std::get<LoggedFrame>(read));
  }
}

void LogDecoder::complain_of(const std::string& why) {
  if (++bad_ <= kMostComplaints) {
    output_.complaint("line " + std::to_string(number_) + ": " + why);
  }
}

Decoder* LogDecoder::decoder_of(const std::string& interface) {
  if (const auto known = decoders_.find(interface); known != decoders_.end()) {
    return &known->second;
  }
  return decoders_.size() >= kMostInterfaces
             ? nullptr
             : &decoders_.try_emplace(interface, model_, bus_of(model_, interface)).first->second;
}

void LogDecoder::show(const LoggedFrame& logged) {
  Decoder* const decoder = decoder_of(logged.interface);
  if (decoder == nullptr) {
    complain_of("more than " + std::to_string(kMostInterfaces) + " interfaces");
    return;
  }
  const Entry entry = decoder->decode(logged.frame, logged.at, logged.origin);
  if (passes(model_, filter_, entry)) {
    output_.line(raw_ ? candump_line(logged.at, logged.interface, logged.frame)
                      : terminal_line(line_of(model_, entry, logged.interface)));
  }
}

}  // namespace trace
