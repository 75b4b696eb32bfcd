#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "bridges/trace/candump.h"
#include "bridges/trace/decoder.h"
#include "bridges/trace/filter.h"
#include "config/model.h"

namespace trace {

/// Decodes a candump log, line by line. A bus is found by its interface or its name; where the model has one bus only,
/// all frames are of that one. What is no line of a log is told with its number, and passed over.
class LogDecoder {
 public:
  /// Texts without the end of their line.
  struct Output {
    std::function<void(const std::string&)> line;       ///< Of the trace.
    std::function<void(const std::string&)> complaint;  ///< `line 17: …`, twenty of them at most.
  };

  /// `model` outlives it.
  LogDecoder(const config::Model& model, Filter filter, bool raw, Output output);

  /// A piece of the log, wherever it ends.
  void take(std::string_view piece);
  /// The log is at its end.
  void finish();
  /// Lines that are none of a log.
  [[nodiscard]] std::size_t bad() const noexcept { return bad_; }

 private:
  void take_line();
  void complain_of(const std::string& why);
  void show(const LoggedFrame& logged);
  /// Null: there are too many interfaces.
  [[nodiscard]] Decoder* decoder_of(const std::string& interface);

  const config::Model& model_;
  Filter filter_;
  bool raw_;
  Output output_;
  std::map<std::string, Decoder, std::less<>> decoders_;  ///< By interface.
  std::string line_;                                      ///< As far as it came; of a long one only the beginning.
  std::size_t number_ = 0;
  std::size_t bad_ = 0;
};

}  // namespace trace
