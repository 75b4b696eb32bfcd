#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "bridges/trace/filter.h"
#include "config/model.h"
#include "daemon/options.h"

namespace gateway {

/// Decodes the lines of a candump log, in their order. A bus is found by its interface or its name; where the model has
/// one bus only, all frames are of that one.
class LogDecoder {
 public:
  /// Both take text with its end of line.
  struct Output {
    std::function<void(const std::string&)> line;       ///< Of the trace.
    std::function<void(const std::string&)> complaint;  ///< About a line of the log.
  };

  /// `model` outlives it.
  LogDecoder(const config::Model& model, trace::Filter filter, bool raw, Output output);
  ~LogDecoder();
  LogDecoder(const LogDecoder&) = delete;
  LogDecoder& operator=(const LogDecoder&) = delete;

  /// A piece of the log, wherever it ends.
  void take(std::string_view piece);
  /// The log is at its end: what is left is a line, too.
  void finish();
  /// Lines that were none.
  [[nodiscard]] std::size_t bad() const noexcept;

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

/// `trace FILE`: a log in the format of `candump -L`, `-` for standard input. What is no line of one is named and
/// passed over; then the exit code is kFailed.
[[nodiscard]] int trace_log(const Options& options, const std::filesystem::path& log, const trace::FilterWords& filter,
                            bool raw);

}  // namespace gateway
