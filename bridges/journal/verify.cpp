#include "bridges/journal/verify.h"

#include <algorithm>

#include "bridges/journal/files.h"
#include "bridges/journal/tail.h"

namespace journal {
namespace {

constexpr std::string_view kTorn = "torn";
constexpr std::string_view kLost = "lost";
constexpr std::string_view kTornText = ": torn: writing it was cut off, it does not count";
// More tell nobody anything.
constexpr std::size_t kMaxRemarks = 100;

std::string lines_text(std::uint64_t first, std::uint64_t last) {
  return first == last ? "line " + std::to_string(first) + " is missing"
                       : "lines " + std::to_string(first) + " to " + std::to_string(last) + " are missing";
}

}  // namespace

void Verifier::begin_file(std::string_view name) {
  file_ = name;
  reader_.emplace([this](const ReadLine& read) { take(read); });
}

void Verifier::add(std::string_view bytes) {
  if (!report_.sound()) {
    return;
  }
  if (unended_) {
    return break_at(*unended_, "changed: it does not end, and more files follow");
  }
  reader_->add(bytes);
}

void Verifier::end_file() {
  ++report_.files;
  const bool unended = reader_->unended();
  const Junk rest = reader_->finish();  // which may take one more line
  if (!report_.sound()) {
    return;
  }
  if (rest.bytes > 0 && (rest.line_breaks > 0 || !unended)) {
    return break_at(place_of(rest.line), "changed: it is no line of a journal");
  }
  if (unended) {
    unended_ = rest.bytes > 0 ? place_of(rest.line) : last_->place;
  }
}

Report Verifier::finish() {
  if (report_.sound() && doubt_) {
    break_at(*doubt_, "changed: its hash is not what the line after it says");
  }
  if (report_.sound() && unended_) {
    const bool counts = last_ && last_->place == *unended_;
    report_.remarks.push_back(*unended_ + (counts ? ": torn: only its line break is missing" : std::string(kTornText)));
  }
  if (last_) {
    report_.newest = last_->n;
    report_.newest_hash = last_->hash;
  }
  return std::move(report_);
}

void Verifier::take(const ReadLine& read) {
  if (!report_.sound()) {
    return;
  }
  if (doubt_) {
    return settle_doubt(read);
  }
  if (!last_) {
    return take_first(read);
  }
  const bool follows = read.line.prev == last_->hash;
  if (follows && read.line.n == last_->n + 1) {
    check_junk(read);
    return accept(read);
  }
  if (read.before.bytes > 0) {
    return break_at(place_of(read.before.line), "changed: it is no line of a journal");
  }
  if (follows || read.line.n <= last_->n) {
    return break_at(place_of(read.number), "changed: it says that it is line " + std::to_string(read.line.n) +
                                               ", after line " + std::to_string(last_->n));
  }
  if (read.line.n > last_->n + 1) {
    return break_at(place_of(read.number), lines_text(last_->n + 1, read.line.n - 1) + " before it");
  }
  // Either the line before is another than it was, or what this one says of it. The next line knows which.
  doubt_ = last_->place;
  last_ = Known{read.line.n, read.hash, place_of(read.number)};
}

// The oldest files may have been removed, never a part of one.
void Verifier::take_first(const ReadLine& read) {
  if (read.line.n == 1 && read.line.prev != kNoHash) {
    return break_at(place_of(read.number), "changed: it is the first line and names one before it");
  }
  if (read.line.n > 1) {
    report_.remarks.push_back(place_of(read.number) + ": the first that is kept is line " +
                              std::to_string(read.line.n) + ", older files were removed");
  }
  check_junk(read);
  accept(read);
}

void Verifier::settle_doubt(const ReadLine& read) {
  const bool confirmed = read.line.prev == last_->hash;
  break_at(confirmed ? *doubt_ : last_->place, confirmed
                                                   ? "changed: its hash is not what the line after it says"
                                                   : "changed: neither the line before nor the one after fits it");
}

// After a crash the gateway writes down which bytes it found behind the last line, as its next line.
void Verifier::check_junk(const ReadLine& read) {
  const bool told = read.line.phase == kTorn;
  if (!told && read.before.bytes == 0) {
    return;
  }
  if (!told) {
    return break_at(place_of(read.before.line), "changed: it is no line of a journal");
  }
  if (read.before.bytes == 0) {
    return break_at(place_of(read.number), "the torn line before it is missing");
  }
  if (read.line.bytes != read.before.bytes || read.line.sha256 != read.before.sha256) {
    return break_at(place_of(read.before.line), "changed: the torn line is another than it was");
  }
  if (report_.remarks.size() < kMaxRemarks) {
    report_.remarks.push_back(place_of(read.before.line) + std::string(kTornText));
  }
}

void Verifier::accept(const ReadLine& read) {
  if (!report_.sound()) {
    return;
  }
  last_ = Known{read.line.n, read.hash, place_of(read.number)};
  ++report_.lines;
  if (report_.lines == 1) {
    report_.from = read.line.ts;
  }
  report_.to = std::max(report_.to, read.line.ts);  // of one form, which sorts as time does
  if (read.line.phase == kLost) {
    report_.lost += read.line.count;
  }
}

void Verifier::break_at(std::string place, std::string_view why) {
  if (report_.sound()) {
    report_.broken = std::move(place) + ": ";
    report_.broken += why;
  }
}

std::string Verifier::place_of(std::uint64_t line) const {
  return file_ + ':' + std::to_string(line);
}

Report verify(const std::filesystem::path& directory, std::error_code& failure) {
  Verifier verifier;
  bool first = true;
  for (const File& file : list_files(directory, failure)) {
    const std::string name = to_string(file.name);
    verifier.begin_file(name);
    failure = read_pieces(directory / name, 0, [&](std::string_view bytes) { verifier.add(bytes); });
    // The gateway may have removed its oldest files meanwhile.
    if (first && failure == std::errc::no_such_file_or_directory) {
      failure.clear();
      continue;
    }
    if (failure) {
      break;
    }
    first = false;
    verifier.end_file();
  }
  return verifier.finish();
}

}  // namespace journal
