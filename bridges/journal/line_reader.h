#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "bridges/journal/line.h"
#include "bridges/journal/sha256.h"

namespace journal {

/// Bytes between two lines of the chain, line breaks included, that are no line of it.
struct Junk {
  std::uint64_t bytes = 0;
  std::uint64_t line = 0;         ///< Where it begins, from 1.
  std::uint64_t line_breaks = 0;  ///< Within.
  std::string sha256;             ///< Empty where there is none.
};

/// A line as it stands in its file.
struct ReadLine {
  Line line;
  std::string hash;
  std::uint64_t number = 0;  ///< In its file, from 1.
  std::uint64_t end = 0;     ///< Bytes of the file up to behind its line break, which the last of a file may lack.
  Junk before;
};

/// Cuts the bytes of one file, which come in pieces, into lines. Takes any bytes in bounded memory.
class LineReader {
 public:
  using Sink = std::function<void(const ReadLine&)>;
  explicit LineReader(Sink sink) : sink_(std::move(sink)) {}

  void add(std::string_view bytes);
  /// At the end of the file: what stands behind the last line. A line that lacks nothing but its line break is one.
  [[nodiscard]] Junk finish();
  /// Whether the file ends in the middle of a line.
  [[nodiscard]] bool unended() const noexcept { return partial_bytes_ > 0; }

 private:
  void add_to_partial(std::string_view bytes);
  void end_line();
  [[nodiscard]] bool take_line();
  void add_junk(std::string_view bytes);
  [[nodiscard]] Junk take_junk();

  Sink sink_;
  std::string partial_;              ///< The line that has not ended yet, as long as it may be one.
  std::uint64_t partial_bytes_ = 0;  ///< Of all of it.
  std::uint64_t offset_ = 0;
  std::uint64_t number_ = 1;  ///< Of that line.
  Junk junk_;
  Sha256 junk_hash_;
};

}  // namespace journal
