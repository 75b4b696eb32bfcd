#include "bridges/mqtt/reach.h"

#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cstdint>

#include "bridges/mqtt/tcp_connection.h"

namespace mqtt {
namespace {

// CONNECT, clean start, without a client id; of version 127 (MQTT 5 §3.1).
constexpr std::array<std::uint8_t, 15> kQuestion{0x10, 13, 0, 4, 'M', 'Q', 'T', 'T', 0x7F, 0x02, 0, 60, 0, 0, 0};

}  // namespace

bool reaches(const config::Endpoint& broker, const std::vector<std::string>& addresses, const TlsFiles& files,
             std::chrono::milliseconds patience) {
  if (broker.tls) {
    return shakes_hands(broker, addresses, files, patience);
  }
  const auto end = std::chrono::steady_clock::now() + patience;
  const TcpConnection connection = connect_to(addresses, broker.port, end);
  if (connection.descriptor < 0 || send(connection.descriptor, kQuestion.data(), kQuestion.size(), MSG_NOSIGNAL) !=
                                       static_cast<ssize_t>(kQuestion.size())) {
    return false;
  }
  std::uint8_t answer = 0;
  return wait_for(connection, POLLIN, end) && recv(connection.descriptor, &answer, sizeof(answer), 0) >= 0;
}

}  // namespace mqtt
