#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "daemon/http/answer.h"
#include "daemon/http/request.h"

// HTTP/1.1 as bytes. All of Boost.Beast stands behind this header.

namespace gateway::http {

/// A longer request is refused unread. Browsers send about 1 kB.
inline constexpr std::size_t kMaxHead = 8UL * 1024;
inline constexpr std::size_t kMaxTarget = 2048;

/// Where the first request ends. Blank lines before it count to it (RFC 9112, section 2.2). Nothing: not all of it is
/// there. `looked`: bytes that were looked at before.
[[nodiscard]] std::optional<std::size_t> find_head_end(std::string_view bytes, std::size_t looked);

/// No request begins like that: TLS, or another protocol.
[[nodiscard]] bool is_foreign(std::string_view bytes);

/// A request that is refused, and the connection ends with the answer.
struct Refused {
  Answer answer;
};

/// Reads the request that ends with `head`. One that has a body, a method other than GET and HEAD, no host or two, or a
/// target that is none, is refused.
[[nodiscard]] std::variant<Request, Refused> read_head(std::string_view head);

/// Status line and headers; the text of the answer follows as it is, unless HEAD was asked for. A stream ends with the
/// connection.
[[nodiscard]] std::string word_head(const Answer& answer, bool keep_alive);

}  // namespace gateway::http
