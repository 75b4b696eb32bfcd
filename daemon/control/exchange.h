#pragma once

#include <boost/asio/local/stream_protocol.hpp>
#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

namespace gateway::control {

/// An answer, or why there is none.
struct Exchanged {
  std::string answer;   ///< A line, without its end.
  std::string problem;  ///< With what can be done about it; empty: there is an answer.
};

/// Connects `socket` to the gateway that listens at `path` and sends it a request. What went wrong, with what can be
/// done about it; empty: it was sent.
[[nodiscard]] std::string send_request(boost::asio::local::stream_protocol::socket& socket,
                                       const std::filesystem::path& path, std::string_view request);

/// Sends one request to the gateway that listens at `path` and waits for its answer, `patience` at most.
[[nodiscard]] Exchanged exchange(const std::filesystem::path& path, std::string_view request,
                                 std::chrono::milliseconds patience);

}  // namespace gateway::control
