#include "daemon/control/follow.h"

#include <poll.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <csignal>
#include <cstring>
#include <optional>

#include "daemon/control/exchange.h"
#include "daemon/control/find_daemon.h"
#include "daemon/descriptors.h"

namespace gateway::control {
namespace {

using boost::asio::local::stream_protocol;
using Time = std::chrono::steady_clock;

volatile std::sig_atomic_t stop_asked = 0;

/// While it lives, SIGINT and SIGTERM are noted; a second one ends the program at once.
class StopNotice {
 public:
  StopNotice() {
    stop_asked = 0;
    struct sigaction action{};
    action.sa_handler = [](int) { stop_asked = 1; };
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    ::sigaction(SIGINT, &action, &before_int_);
    ::sigaction(SIGTERM, &action, &before_term_);
  }
  ~StopNotice() {
    ::sigaction(SIGINT, &before_int_, nullptr);
    ::sigaction(SIGTERM, &before_term_, nullptr);
  }
  StopNotice(const StopNotice&) = delete;
  StopNotice& operator=(const StopNotice&) = delete;

 private:
  struct sigaction before_int_{};
  struct sigaction before_term_{};
};

// Waits a little for something to read; a signal that comes just before is seen after it.
bool is_readable(int socket) {
  constexpr int kLook = 200;  // ms
  pollfd waiting{.fd = socket, .events = POLLIN, .revents = 0};
  return ::poll(&waiting, 1, kLook) > 0;
}

// Hands on the whole lines of what was received. False: enough.
bool hand_on(std::string& received, const std::function<bool(std::string_view)>& take) {
  std::size_t begin = 0;
  bool goes_on = true;
  for (std::size_t end = received.find('\n'); goes_on && end != std::string::npos; end = received.find('\n', begin)) {
    goes_on = take(std::string_view(received).substr(begin, end - begin));
    begin = end + 1;
  }
  received.erase(0, begin);
  return goes_on;
}

/// What a line is beside what it tells.
struct Judged {
  std::optional<std::string> refusal{};
  bool ends = false;
};

Judged judge(std::string_view line) {
  boost::json::error_code failed;
  const boost::json::value read = boost::json::parse(boost::json::string_view(line.data(), line.size()), failed);
  const boost::json::object* const members = failed ? nullptr : read.if_object();
  if (members == nullptr) {
    return {.refusal = "what listens there is no gateway"};
  }
  const boost::json::value* const ok = members->if_contains("ok");
  if (ok != nullptr && ok->is_bool() && !ok->as_bool()) {
    const boost::json::value* const error = members->if_contains("error");
    const bool has_text = error != nullptr && error->is_string();
    return {.refusal = has_text ? std::string(error->as_string().c_str()) : "refused"};
  }
  return {.ends = members->contains("end")};
}

}  // namespace

std::string_view only_member(std::string_view line, std::string_view name) {
  const std::string before = R"({"id":1,")" + std::string(name) + "\":";
  return line.starts_with(before) ? line.substr(before.size(), line.size() - before.size() - 1) : std::string_view{};
}

Followed follow(const std::filesystem::path& path, std::string_view request, std::chrono::milliseconds patience,
                const std::function<bool(std::string_view)>& take) {
  const StopNotice notice;
  boost::asio::io_context unused;  // nothing here is asynchronous
  stream_protocol::socket socket(unused);
  if (std::string problem = send_request(socket, path, request); !problem.empty()) {
    return {.problem = std::move(problem)};
  }
  const Time::time_point end = Time::now() + patience;
  bool answered = false;
  std::string received;
  std::array<char, 65536> buffer{};
  while (stop_asked == 0) {
    if (!is_readable(socket.native_handle())) {
      if (!answered && Time::now() >= end) {
        return {.problem = "the gateway has not answered in time"};
      }
      continue;
    }
    boost::system::error_code failed;
    received.append(buffer.data(), socket.read_some(boost::asio::buffer(buffer), failed));
    answered = true;
    if (!hand_on(received, take)) {
      return {};
    }
    if (failed) {
      return {.problem = "the gateway ended the connection; it ends, or another client needed the place"};
    }
  }
  return {.interrupted = true, .problem = {}};
}

int follow_stream(const Reach& reach, std::string_view request, const std::function<void(std::string_view)>& take) {
  const std::optional<Daemon> daemon = find_daemon(reach);
  if (!daemon) {
    return kConfigurationError;
  }
  if (daemon->socket.empty()) {
    complain("[gateway] control is empty: this gateway has no control socket");
    return kFailed;
  }
  bool begun = false;
  Judged judged;
  const Followed followed = follow(daemon->socket, request, daemon->patience, [&](std::string_view line) {
    if (!begun || line.find("\"end\":true") != std::string_view::npos) {
      judged = judge(line);
      begun = true;
    } else {
      take(line);
    }
    return !judged.refusal && !judged.ends;
  });
  if (followed.interrupted) {
    return kDone;
  }
  complain(judged.refusal ? *judged.refusal : judged.ends ? "the gateway has ended" : followed.problem);
  return kFailed;
}

}  // namespace gateway::control
