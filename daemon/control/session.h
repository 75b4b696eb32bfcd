#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

#include "daemon/control/exchange.h"

namespace gateway::control {

/// Connects to the gateway that listens at `path`. Why it could not, with what can be done about it; empty: it has.
[[nodiscard]] std::string connect_to_gateway(boost::asio::local::stream_protocol::socket& socket,
                                             const std::filesystem::path& path);

/// A connection to the gateway for several requests, one after the other. Everything waits.
class Session {
 public:
  /// Connects; problem() says why it could not.
  explicit Session(const std::filesystem::path& path);

  /// Why there is no connection, with what can be done about it; empty: there is one.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  /// Sends a request and waits for the line that answers it, `patience` at most. After a problem nothing more can be
  /// asked: a late answer would be taken for that of the next request.
  [[nodiscard]] Exchanged ask(std::string_view request, std::chrono::milliseconds patience);

 private:
  Exchanged fail(std::string problem);
  Exchanged read_line(std::chrono::milliseconds patience);

  boost::asio::io_context unused_{};  ///< Nothing here is asynchronous.
  boost::asio::local::stream_protocol::socket socket_{unused_};
  std::string received_{};
  std::string problem_{};
};

}  // namespace gateway::control
