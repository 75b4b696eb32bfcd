#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "bridges/text/flat_json.h"
#include "canopen/error.h"

namespace gateway::control {

/// A longer line is refused unread.
inline constexpr std::size_t kMaxLine = 16UL * 1024;

enum class Op : std::uint8_t { set, nmt, sdo_read, sdo_write, status, stop, trace, buses, record };

/// What one line asks for. Which members an op has is checked, and nothing that needs the configuration.
struct Request {
  Op op = Op::status;
  std::string drive{};                  ///< Of all but `status`, `stop`, `trace`, `buses`; of `record` this or `bus`.
  std::string bus{};                    ///< Of `record`.
  text::FlatObject values{};            ///< Of `set`: signals and their values.
  std::string command{};                ///< Of `nmt`.
  std::string object{};                 ///< Of `sdo-read` and `sdo-write`: `0x2002:03`.
  std::optional<std::string> type{};    ///< Likewise; nothing: that of the signal with this object.
  std::optional<text::Scalar> value{};  ///< Of `sdo-write`: raw, as the device holds it.
  bool watch = false;                   ///< Of `status`: again and again.
  std::string names{};                  ///< Of `trace`, as trace::FilterWords has them.
  std::string kinds{};
  std::string cob_ids{};
  bool raw = false;  ///< Of `trace`: as candump writes it.
};

/// It is answered on and on.
[[nodiscard]] constexpr bool is_stream(const Request& request) noexcept {
  return request.op == Op::trace || request.watch;
}

/// A line taken apart.
struct Line {
  std::string id = "null";  ///< To echo, as JSON text; null where the line has none, or none that can be read.
  canopen::Result<Request> request;
};

/// Reads one line, without its end. `type` for what is no request, `unknown` for an op that there is not.
[[nodiscard]] Line parse_line(std::string_view text);

/// What is answered to a line that is longer than kMaxLine.
[[nodiscard]] canopen::Error too_long();

}  // namespace gateway::control
