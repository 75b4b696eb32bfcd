#include "daemon/trace_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <map>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "bridges/trace/candump.h"
#include "bridges/trace/decoder.h"
#include "bridges/trace/line.h"
#include "daemon/descriptors.h"
#include "daemon/output.h"

namespace gateway {
namespace {

// Beyond them bad lines are only counted: it is no log at all.
constexpr std::size_t kMostComplaints = 20;
// Of interfaces, which are names of the log: no more than a machine has.
constexpr std::size_t kMostInterfaces = 64;

std::optional<std::size_t> bus_of(const config::Model& model, std::string_view interface) {
  for (std::size_t i = 0; i < model.buses.size(); ++i) {
    if (model.buses[i].interface == interface || model.buses[i].name == interface) {
      return i;
    }
  }
  return model.buses.size() == 1 ? std::optional<std::size_t>(0) : std::nullopt;
}

}  // namespace

class LogDecoder::Body {
 public:
  Body(const config::Model& model, trace::Filter filter, bool raw, Output output)
      : model_(model), filter_(std::move(filter)), raw_(raw), output_(std::move(output)) {}

  void take(std::string_view piece) {
    while (!piece.empty()) {
      const std::size_t end = std::min(piece.find('\n'), piece.size());
      // Of a line without end no more is kept than tells that it is none.
      const std::size_t room = trace::kMaxLogLine + 1 - std::min(line_.size(), trace::kMaxLogLine + 1);
      line_.append(piece.substr(0, std::min(end, room)));
      if (end < piece.size()) {
        finish();
      }
      piece.remove_prefix(std::min(end + 1, piece.size()));
    }
  }

  void finish() {
    std::string line = std::exchange(line_, {});
    ++number_;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) {
      line.pop_back();
    }
    if (line.empty()) {
      return;
    }
    const auto read = trace::parse_candump_line(line);
    if (const auto* const none = std::get_if<trace::NoFrame>(&read)) {
      complain_of(none->why);
    } else {
      show(std::get<trace::LoggedFrame>(read));
    }
  }

  void flush() {
    if (!line_.empty()) {
      finish();
    }
    if (bad_ > kMostComplaints) {
      output_.complaint(std::to_string(bad_ - kMostComplaints) + " further lines are none of a log\n");
    }
  }

  [[nodiscard]] std::size_t bad() const noexcept { return bad_; }

 private:
  void complain_of(const std::string& why) {
    if (++bad_ <= kMostComplaints) {
      output_.complaint("line " + std::to_string(number_) + ": " + why + "\n");
    }
  }

  void show(const trace::LoggedFrame& logged) {
    const auto known = decoders_.find(logged.interface);
    if (known == decoders_.end() && decoders_.size() >= kMostInterfaces) {
      complain_of("more than " + std::to_string(kMostInterfaces) + " interfaces");
      return;
    }
    trace::Decoder& decoder =
        known != decoders_.end()
            ? known->second
            : decoders_.try_emplace(logged.interface, model_, bus_of(model_, logged.interface)).first->second;
    const trace::Entry entry = decoder.decode(logged.frame, logged.at, logged.origin);
    if (!trace::passes(model_, filter_, entry)) {
      return;
    }
    output_.line((raw_ ? trace::candump_line(logged.at, logged.interface, logged.frame)
                       : trace::terminal_line(trace::line_of(model_, entry, logged.interface))) +
                 "\n");
  }

  const config::Model& model_;
  trace::Filter filter_;
  bool raw_;
  Output output_;
  std::map<std::string, trace::Decoder, std::less<>> decoders_;  ///< By interface.
  std::string line_;
  std::size_t number_ = 0;
  std::size_t bad_ = 0;
};

LogDecoder::LogDecoder(const config::Model& model, trace::Filter filter, bool raw, Output output)
    : body_(std::make_unique<Body>(model, std::move(filter), raw, std::move(output))) {}

LogDecoder::~LogDecoder() = default;

void LogDecoder::take(std::string_view piece) {
  body_->take(piece);
}

void LogDecoder::finish() {
  body_->flush();
}

std::size_t LogDecoder::bad() const noexcept {
  return body_->bad();
}

int trace_log(const Options& options, const std::filesystem::path& log, const trace::FilterWords& words, bool raw) {
  const std::optional<config::Model> model = load_or_complain(options, Secrets::leave);
  if (!model) {
    return kConfigurationError;
  }
  canopen::Result<trace::Filter> filter = trace::make_filter(*model, words);
  if (filter.has_error()) {
    complain(filter.error().detail);
    return kUsage;
  }
  const bool is_input = log == "-";
  const int file = is_input ? STDIN_FILENO : ::open(log.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    complain(log.string() + ": " + std::generic_category().message(errno));
    return kFailed;
  }
  LogDecoder decoder(
      *model, std::move(filter.value()), raw,
      {.line = [](const std::string& text) { print(text); },
       .complaint =
           [&log](const std::string& text) { complain(log.string() + ": " + text.substr(0, text.size() - 1)); }});
  std::array<char, 65536> buffer{};
  ssize_t count = 0;
  while ((count = ::read(file, buffer.data(), buffer.size())) > 0 || (count < 0 && errno == EINTR)) {
    decoder.take(std::string_view(buffer.data(), count > 0 ? static_cast<std::size_t>(count) : 0));
  }
  const int failed = count < 0 ? errno : 0;
  if (!is_input) {
    ::close(file);
  }
  decoder.finish();
  if (failed != 0) {
    complain(log.string() + ": " + std::generic_category().message(failed));
  }
  return failed == 0 && decoder.bad() == 0 ? kDone : kFailed;
}

}  // namespace gateway
