#include "daemon/control/exchange.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/write.hpp>
#include <boost/system/error_code.hpp>
#include <cerrno>

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

Exchanged problem(std::string text) {
  return {.answer = {}, .problem = std::move(text)};
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

Exchanged read_answer(stream_protocol::socket& socket, std::chrono::milliseconds patience) {
  const Time::time_point end = Time::now() + patience;
  std::string answer;
  std::array<char, 4096> buffer{};
  while (answer.find('\n') == std::string::npos) {
    if (!wait_for_more(socket.native_handle(), end)) {
      return problem("the gateway has not answered within " +
                     std::to_string(std::chrono::duration_cast<std::chrono::seconds>(patience).count()) +
                     " s; what became of the request is unknown");
    }
    error_code failed;
    answer.append(buffer.data(), socket.read_some(boost::asio::buffer(buffer), failed));
    if (failed) {
      return problem("the gateway ended the connection without an answer (" + failed.message() +
                     "); it ends, or too many clients are connected. What became of the request is unknown");
    }
  }
  answer.resize(answer.find('\n'));
  return {.answer = std::move(answer), .problem = {}};
}

}  // namespace

std::string send_request(stream_protocol::socket& socket, const std::filesystem::path& path, std::string_view request) {
  const std::string at = path.string();
  if (at.empty() || at.size() >= sizeof(sockaddr_un::sun_path)) {
    return "\"" + at + "\" is no path of a socket: from 1 to " + std::to_string(sizeof(sockaddr_un::sun_path) - 1) +
           " bytes";
  }
  error_code failed;
  socket.connect(stream_protocol::endpoint(at), failed);
  if (failed) {
    return "cannot reach the gateway at " + at + ": " + failed.message() + remedy(failed);
  }
  boost::asio::write(socket, boost::asio::buffer(std::string(request) + "\n"), failed);
  return failed ? "the gateway ended the connection: " + failed.message() : std::string();
}

Exchanged exchange(const std::filesystem::path& path, std::string_view request, std::chrono::milliseconds patience) {
  boost::asio::io_context unused;  // nothing here is asynchronous
  stream_protocol::socket socket(unused);
  std::string wrong = send_request(socket, path, request);
  return wrong.empty() ? read_answer(socket, patience) : problem(std::move(wrong));
}

}  // namespace gateway::control
