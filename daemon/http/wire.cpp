#include "daemon/http/wire.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/status.hpp>
#include <boost/beast/http/verb.hpp>
#include <boost/system/error_code.hpp>
#include <chrono>
#include <ctime>
#include <limits>
#include <utility>

#include "canopen/clock.h"

namespace gateway::http {
namespace {

namespace beast_http = boost::beast::http;
using Parser = beast_http::request_parser<beast_http::empty_body>;

constexpr std::string_view kEnd = "\r\n\r\n";
constexpr std::string_view kMethods = "GET, HEAD";

// Whatever is answered loads nothing and runs nothing,
constexpr std::string_view kNothing = "default-src 'none'";
// but for the page, which loads and runs what this server has, and nothing that is written into it;
constexpr std::string_view kOwn =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'";
// and is shown in no frame, and is kept by nobody.
constexpr std::string_view kGuards =
    "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "X-Frame-Options: DENY\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Cache-Control: no-store\r\n";

// RFC 9110, section 5.6.7; no locale has a say.
std::string date_text(canopen::WallTime now) {
  constexpr std::array<std::string_view, 7> kDays{"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  constexpr std::array<std::string_view, 12> kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                     "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const auto day = std::chrono::floor<std::chrono::days>(now);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss time(std::chrono::floor<std::chrono::seconds>(now - day));
  return fmt::format("{}, {:02} {} {:04} {:02}:{:02}:{:02} GMT", kDays.at(std::chrono::weekday(day).c_encoding()),
                     static_cast<unsigned>(date.day()), kMonths.at(static_cast<unsigned>(date.month()) - 1),
                     static_cast<int>(date.year()), time.hours().count(), time.minutes().count(),
                     time.seconds().count());
}

bool has_body(const Parser& parser) {
  return parser.get().count(beast_http::field::transfer_encoding) != 0 || parser.content_length().value_or(0) != 0;
}

std::string_view text_of(boost::beast::string_view view) {
  return {view.data(), view.size()};
}

std::optional<Answer> objection(const Parser& parser) {
  const auto& message = parser.get();
  if (message.method() != beast_http::verb::get && message.method() != beast_http::verb::head) {
    Answer answer = refusal(405,
                            "this server only shows: GET and HEAD are all that it takes; commands go by Modbus, "
                            "MQTT or the command line");
    answer.allow = kMethods;
    return answer;
  }
  if (has_body(parser)) {
    return refusal(413, "a request here has no body; leave Content-Length and Transfer-Encoding out");
  }
  if (message.target().size() > kMaxTarget) {
    return refusal(414, fmt::format("the target is longer than {} bytes", kMaxTarget));
  }
  if (message.count(beast_http::field::host) != 1) {
    return refusal(400, "a request has one header Host, which names this machine");
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::size_t> find_head_end(std::string_view bytes, std::size_t looked) {
  const std::size_t first = std::min(bytes.find_first_not_of("\r\n"), bytes.size());
  const std::size_t from = std::max(first, looked < kEnd.size() ? 0 : looked - (kEnd.size() - 1));
  const std::size_t end = bytes.find(kEnd, from);
  return end == std::string_view::npos ? std::nullopt : std::optional(end + kEnd.size());
}

bool is_foreign(std::string_view bytes) {
  const std::size_t first = bytes.find_first_not_of("\r\n");
  return first != std::string_view::npos && (bytes[first] < 'A' || bytes[first] > 'Z');
}

std::variant<Request, Refused> read_head(std::string_view head) {
  head.remove_prefix(std::min(head.find_first_not_of("\r\n"), head.size()));
  Parser parser;
  parser.header_limit(kMaxHead);
  parser.body_limit(std::numeric_limits<std::uint64_t>::max());  // what has a body is refused for that
  boost::system::error_code failed;
  parser.put(boost::asio::buffer(head), failed);
  if (!parser.is_header_done()) {
    return Refused{refusal(400, "this is no HTTP/1.1 request: " + failed.message())};
  }
  if (auto answer = objection(parser)) {
    return Refused{*std::move(answer)};
  }
  auto target = parse_target(text_of(parser.get().target()));
  if (const auto* const mistake = std::get_if<TargetMistake>(&target)) {
    return Refused{refusal(400, mistake->text)};
  }
  Request request{.method = parser.get().method() == beast_http::verb::head ? Method::head : Method::get,
                  .target = std::get<Target>(std::move(target)),
                  .host = std::string(text_of(parser.get().at(beast_http::field::host))),
                  .keep_alive = parser.get().keep_alive()};
  if (!request.target.host.empty()) {
    request.host = request.target.host;  // RFC 9112, section 3.2.2
  }
  return request;
}

std::string word_head(const Answer& answer, bool keep_alive) {
  const auto reason = text_of(beast_http::obsolete_reason(beast_http::int_to_status(answer.status)));
  std::string head =
      fmt::format("HTTP/1.1 {} {}\r\nDate: {}\r\nContent-Type: {}\r\nContent-Security-Policy: {}{}", answer.status,
                  reason, date_text(canopen::wall_now()), answer.type, answer.page ? kOwn : kNothing, kGuards);
  if (!answer.stream) {
    head += fmt::format("Content-Length: {}\r\n", answer.size());
  }
  if (!answer.attachment.empty()) {
    head += fmt::format("Content-Disposition: attachment; filename=\"{}\"\r\n", answer.attachment);
  }
  if (!answer.allow.empty()) {
    head += fmt::format("Allow: {}\r\n", answer.allow);
  }
  if (answer.come_again) {
    head += "Retry-After: 5\r\n";
  }
  return head + (keep_alive && !answer.stream ? "Connection: keep-alive\r\n\r\n" : "Connection: close\r\n\r\n");
}

}  // namespace gateway::http
