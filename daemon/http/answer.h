#pragma once

#include <span>
#include <string>
#include <string_view>

namespace gateway::http {

/// What is sent back, but for what all answers have alike.
struct Answer {
  unsigned status = 200;
  std::string_view type = "application/json";
  std::string body{};
  const std::string* lasting = nullptr;  ///< In place of `body`: it outlives every connection.
  bool page = false;                     ///< A browser shows it, with what else this server has.
  bool stream = false;                   ///< Events follow, for as long as the client stays.
  std::string_view allow{};              ///< The methods that there are; empty: not told.

  [[nodiscard]] std::string_view text() const noexcept { return lasting != nullptr ? *lasting : body; }
};

/// `{"error":"…"}`
[[nodiscard]] Answer refusal(unsigned status, std::string_view why);
/// `{"error":"…","drives":["fan1","pump1"]}`: what there is instead, under `key`.
[[nodiscard]] Answer refusal(unsigned status, std::string_view why, std::string_view key,
                             std::span<const std::string> known);

}  // namespace gateway::http
