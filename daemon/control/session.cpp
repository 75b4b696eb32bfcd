#include "daemon/control/session.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <boost/system/error_code.hpp>
#include <cerrno>
#include <utility>

namespace gateway::control {
namespace {

using boost::asio::local::stream_protocol;
using boost::system::error_code;
using Time = std::chrono::steady_clock;

std::string remedy(const error_code& cause) {
  if (cause == boost::asio::error::access_denied) {
    return "; only root and the members of its group may: `sudo usermod -aG canopen-gateway $USER` and a new login, or "
           "`sudo`";
  }
  return "; does the gateway run (`systemctl status canopen-gateway`), and with this path? --control names another";
}

// False at the end of the patience.
bool wait_for_more(int socket, Time::time_point end) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Time::now());
    if (left.count() <= 0) {
      return false;
    }
    pollfd waiting{.fd = socket, .events = POLLIN, .revents = 0};
    const int ready = ::poll(&waiting, 1, static_cast<int>(left.count()));
    if (ready != 0 && (ready > 0 || errno != EINTR)) {
      return true;  // whatever failed, reading tells better
    }
  }
}

}  // namespace

std::string connect_to_gateway(stream_protocol::socket& socket, const std::filesystem::path& path) {
  const std::string at = path.string();
  if (at.empty() || at.size() >= sizeof(sockaddr_un::sun_path)) {
    return "\"" + at + "\" is no path of a socket: from 1 to " + std::to_string(sizeof(sockaddr_un::sun_path) - 1) +
           " bytes";
  }
  error_code failed;
  socket.connect(stream_protocol::endpoint(at), failed);
  return failed ? "cannot reach the gateway at " + at + ": " + failed.message() + remedy(failed) : std::string();
}

Session::Session(const std::filesystem::path& path) : problem_(connect_to_gateway(socket_, path)) {}

Exchanged Session::ask(std::string_view request, std::chrono::milliseconds patience) {
  if (!problem_.empty()) {
    return {.answer = {}, .problem = problem_};
  }
  error_code failed;
  boost::asio::write(socket_, boost::asio::buffer(std::string(request) + "\n"), failed);
  if (failed) {
    return fail("the gateway ended the connection: " + failed.message());
  }
  return read_line(patience);
}

Exchanged Session::fail(std::string problem) {
  problem_ = std::move(problem);
  return {.answer = {}, .problem = problem_};
}

Exchanged Session::read_line(std::chrono::milliseconds patience) {
  const Time::time_point end = Time::now() + patience;
  std::array<char, 4096> buffer{};
  std::size_t length = 0;
  while ((length = received_.find('\n')) == std::string::npos) {
    if (!wait_for_more(socket_.native_handle(), end)) {
      return fail("the gateway has not answered within " +
                  std::to_string(std::chrono::duration_cast<std::chrono::seconds>(patience).count()) +
                  " s; what became of the request is unknown");
    }
    error_code failed;
    received_.append(buffer.data(), socket_.read_some(boost::asio::buffer(buffer), failed));
    if (failed) {
      return fail("the gateway ended the connection without an answer (" + failed.message() +
                  "); it ends, or too many clients are connected. What became of the request is unknown");
    }
  }
  std::string answer = received_.substr(0, length);
  received_.erase(0, length + 1);
  return {.answer = std::move(answer), .problem = {}};
}

}  // namespace gateway::control
