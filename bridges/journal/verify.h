#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/journal/line_reader.h"

namespace journal {

/// What was found in a journal.
struct Report {
  std::string broken;                ///< `2026-11-26.jsonl:17: …`, the first line that was changed or is missing.
  std::vector<std::string> remarks;  ///< What is in order and worth knowing: older lines removed, torn lines.
  // The rest tells of a sound one only.
  std::uint64_t lines = 0;
  std::uint64_t files = 0;
  std::uint64_t lost = 0;    ///< Lines that the gateway says it could not write.
  std::string from;          ///< `ts` of the first line.
  std::string to;            ///< The latest `ts`: a line that counts others has that of the last of them, and is late.
  std::uint64_t newest = 0;  ///< `n` of the last one; 0: there is none.
  std::string newest_hash;

  [[nodiscard]] bool sound() const noexcept { return broken.empty(); }
};

/// Follows the chain through the files of a journal, which come in their order and in pieces.
class Verifier {
 public:
  Verifier() = default;
  Verifier(const Verifier&) = delete;
  Verifier& operator=(const Verifier&) = delete;

  void begin_file(std::string_view name);
  void add(std::string_view bytes);
  void end_file();
  /// At the end of the last file.
  [[nodiscard]] Report finish();

 private:
  struct Known {
    std::uint64_t n = 0;
    std::string hash;
    std::string place;
  };

  void take(const ReadLine& read);
  void take_first(const ReadLine& read);
  void settle_doubt(const ReadLine& read);
  void check_junk(const ReadLine& read);
  void accept(const ReadLine& read);
  void break_at(std::string place, std::string_view why);
  [[nodiscard]] std::string place_of(std::uint64_t line) const;

  Report report_;
  std::string file_;
  std::optional<LineReader> reader_;
  std::optional<Known> last_;
  std::optional<std::string> doubt_;    ///< A line whose hash is not what the one after it says.
  std::optional<std::string> unended_;  ///< A line that stands at the end of a file and does not end.
};

/// All files of a directory. `failure`: they could not be read.
[[nodiscard]] Report verify(const std::filesystem::path& directory, std::error_code& failure);

}  // namespace journal
