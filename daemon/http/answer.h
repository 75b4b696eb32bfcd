#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gateway::http {

class EventSource;

struct Progress {
  bool goes_on = false;  ///< There are further pieces.
  std::size_t kept = 0;  ///< Bytes that wait outside of the text until they can be put into it.
};

/// Appends the next piece of a text: about a millisecond's work at most.
using Pieces = std::function<Progress(std::string& text)>;

/// A file that is sent a piece at a time, as the client takes it.
struct FileBody {
  std::uint64_t size = 0;  ///< Bytes.
  /// The next ones from there on; nothing where they cannot be read.
  std::function<boost::asio::awaitable<std::optional<std::string>>(std::uint64_t offset)> read;
};

/// What is sent back, but for what all answers have alike.
struct Answer {
  unsigned status = 200;
  std::string_view type = "application/json";
  std::string body{};
  Pieces rest{};  ///< Further text behind `body`: the loop has a turn between its pieces.
  /// In place of `body`: it outlives every connection, or `shared` keeps it.
  const std::string* lasting = nullptr;
  std::shared_ptr<const std::string> shared{};
  bool page = false;    ///< A browser shows it, with what else this server has.
  bool stream = false;  ///< Events follow, for as long as the client stays.
  /// Begins them, of a stream that is this reader's own; none: those of all readers, see LiveSource.
  std::function<std::unique_ptr<EventSource>()> events{};
  bool come_again = false;         ///< There is too much to do: `Retry-After` tells when to ask the same again.
  std::string_view allow{};        ///< The methods that there are; empty: not told.
  std::string attachment{};        ///< A browser is to save it by this name; empty: it is shown.
  std::optional<FileBody> file{};  ///< In place of `body`.

  [[nodiscard]] std::uint64_t size() const noexcept { return file ? file->size : text().size(); }
  [[nodiscard]] std::string_view text() const noexcept { return lasting != nullptr ? *lasting : body; }
};

/// Of what a client wrote, as much as a refusal repeats.
[[nodiscard]] inline std::string_view beginning(std::string_view foreign) {
  return foreign.substr(0, 100);
}
/// `{"error":"…"}`
[[nodiscard]] Answer refusal(unsigned status, std::string_view why);
/// 503, since others take too much; the client may come again.
[[nodiscard]] Answer too_much(std::string_view why);
/// `{"error":"…","drives":["fan1","pump1"]}`: what there is instead, under `key`.
[[nodiscard]] Answer refusal(unsigned status, std::string_view why, std::string_view key,
                             std::span<const std::string> known);

}  // namespace gateway::http
