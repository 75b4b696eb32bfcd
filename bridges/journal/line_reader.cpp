#include "bridges/journal/line_reader.h"

#include <utility>

namespace journal {

void LineReader::add(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t line_break = bytes.find('\n');
    add_to_partial(bytes.substr(0, line_break));
    if (line_break == std::string_view::npos) {
      return;
    }
    end_line();
    bytes.remove_prefix(line_break + 1);
  }
}

Junk LineReader::finish() {
  if (partial_bytes_ > 0 && !take_line()) {
    add_junk(partial_);
  }
  partial_.clear();
  return take_junk();
}

// What is longer than any line goes into the hash at once, so that it takes no memory.
void LineReader::add_to_partial(std::string_view bytes) {
  offset_ += bytes.size();
  const bool was_too_long = partial_bytes_ > kMaxLine;
  partial_bytes_ += bytes.size();
  if (!was_too_long) {
    partial_ += bytes;
  } else {
    add_junk(bytes);
  }
  if (!was_too_long && partial_bytes_ > kMaxLine) {
    add_junk(std::exchange(partial_, {}));
  }
}

void LineReader::end_line() {
  ++offset_;
  if (!take_line()) {
    partial_ += '\n';
    add_junk(partial_);
    ++junk_.line_breaks;
  }
  partial_.clear();
  partial_bytes_ = 0;
  ++number_;
}

bool LineReader::take_line() {
  const auto line = partial_bytes_ > kMaxLine ? std::nullopt : parse_line(partial_);
  if (!line) {
    return false;
  }
  sink_({.line = *line, .hash = sha256(partial_), .number = number_, .end = offset_, .before = take_junk()});
  return true;
}

void LineReader::add_junk(std::string_view bytes) {
  if (bytes.empty()) {
    return;
  }
  if (junk_.bytes == 0) {
    junk_.line = number_;
  }
  junk_.bytes += bytes.size();
  junk_hash_.add(bytes);
}

Junk LineReader::take_junk() {
  if (junk_.bytes > 0) {
    junk_.sha256 = junk_hash_.finish();
  }
  return std::exchange(junk_, {});
}

}  // namespace journal
