// Any bytes as a journal of two files: the verdict does not depend on how they were read, and a journal without
// anything to say of consists of its lines and nothing else.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "bridges/journal/verify.h"

namespace {

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void read_file(journal::Verifier& verifier, std::string_view name, std::string_view bytes, std::size_t piece) {
  verifier.begin_file(name);
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    verifier.add(bytes.substr(at, piece));
  }
  verifier.end_file();
}

journal::Report read_all(std::string_view first, std::string_view second, std::size_t piece) {
  journal::Verifier verifier;
  read_file(verifier, "first", first, piece);
  read_file(verifier, "second", second, piece);
  return verifier.finish();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) {
    return 0;
  }
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 2, size - 2);
  // At a line break mostly, so that the chain goes on over files.
  std::size_t cut = bytes.size() * data[0] / 255;
  cut = (data[1] & 1) != 0 ? std::min(bytes.find('\n', cut), bytes.size() - 1) + 1 : cut;
  cut = std::min(cut, bytes.size());
  const std::string_view first = bytes.substr(0, cut);
  const std::string_view second = bytes.substr(cut);

  const journal::Report whole = read_all(first, second, std::max<std::size_t>(bytes.size(), 1));
  const journal::Report pieces = read_all(first, second, 1 + data[1] / 2);
  require(whole.broken == pieces.broken && whole.remarks == pieces.remarks && whole.lines == pieces.lines &&
          whole.newest == pieces.newest && whole.newest_hash == pieces.newest_hash);
  require(whole.files == 2);
  const auto breaks = static_cast<std::uint64_t>(std::count(bytes.begin(), bytes.end(), '\n'));
  require(whole.lines <= breaks + 2);
  if (whole.sound() && whole.remarks.empty()) {
    require(whole.lines == breaks);
    require(whole.newest == whole.lines);
  }
  return 0;
}
