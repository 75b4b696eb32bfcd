#include "daemon/control/exchange.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <boost/system/error_code.hpp>

#include "daemon/control/session.h"

namespace gateway::control {

std::string send_request(boost::asio::local::stream_protocol::socket& socket, const std::filesystem::path& path,
                         std::string_view request) {
  if (std::string problem = connect_to_gateway(socket, path); !problem.empty()) {
    return problem;
  }
  boost::system::error_code failed;
  boost::asio::write(socket, boost::asio::buffer(std::string(request) + "\n"), failed);
  return failed ? "the gateway ended the connection: " + failed.message() : std::string();
}

Exchanged exchange(const std::filesystem::path& path, std::string_view request, std::chrono::milliseconds patience) {
  return Session(path).ask(request, patience);
}

}  // namespace gateway::control
