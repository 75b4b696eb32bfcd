#include "daemon/trace_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "bridges/trace/log_decoder.h"
#include "daemon/descriptors.h"
#include "daemon/output.h"

namespace gateway {
namespace {

// Decodes all of an open file; what the system said where that could not be read.
std::error_code decode_file(int file, trace::LogDecoder& decoder) {
  std::array<char, 65536> buffer{};
  for (;;) {
    const ssize_t count = ::read(file, buffer.data(), buffer.size());
    if (count == 0 || (count < 0 && errno != EINTR)) {
      decoder.finish();
      return count < 0 ? std::error_code(errno, std::generic_category()) : std::error_code();
    }
    if (count > 0) {
      decoder.take(std::string_view(buffer.data(), static_cast<std::size_t>(count)));
    }
  }
}

}  // namespace

int trace_log(const Options& options, const std::filesystem::path& log, const trace::FilterWords& words, bool raw) {
  // Nobody asked for its warnings: `check` has them.
  const config::Loaded loaded = config::load(load_options(options));
  const std::optional<config::Model>& model = loaded.model;
  if (!model) {
    show_findings(loaded.findings);
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
  trace::LogDecoder decoder(*model, std::move(filter.value()), raw,
                            {.line = [](const std::string& text) { print(text + "\n"); },
                             .complaint = [&log](const std::string& text) { complain(log.string() + ": " + text); }});
  const std::error_code failed = decode_file(file, decoder);
  if (!is_input) {
    ::close(file);
  }
  if (failed) {
    complain(log.string() + ": " + failed.message());
  }
  return !failed && decoder.bad() == 0 ? kDone : kFailed;
}

}  // namespace gateway
