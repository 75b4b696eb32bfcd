// Sockets that a service manager bound and passed.

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <bit>
#include <cstdint>
#include <string>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::example_model;
using modbus_test::Site;
using modbus_test::TcpClient;

struct Bound {
  int descriptor;
  std::uint16_t port;
};

Bound bound(const char* host, int type = SOCK_STREAM, std::uint16_t port = 0) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  ::inet_pton(AF_INET, host, &address.sin_addr);
  socklen_t size = sizeof address;
  auto* const any = std::bit_cast<sockaddr*>(&address);
  const int descriptor = ::socket(AF_INET, type | SOCK_CLOEXEC, 0);
  EXPECT_EQ(::bind(descriptor, any, size), 0);
  if (type == SOCK_STREAM) {
    EXPECT_EQ(::listen(descriptor, 8), 0);
  }
  EXPECT_EQ(::getsockname(descriptor, any, &size), 0);
  return {descriptor, ntohs(address.sin_port)};
}

bool is_open(int descriptor) {
  return ::fcntl(descriptor, F_GETFD) >= 0;
}

TEST(PassedSockets, ServesTheEntryWithItsAddressAndPort) {
  const Bound passed = bound("127.0.0.3");
  config::Model model = example_model();
  model.modbus->listen = {{"127.0.0.1", 0}, {"127.0.0.3", passed.port}};
  TcpClient early(passed.port, "127.0.0.3");  // it waits since before the start
  Site site(model, {passed.descriptor});
  EXPECT_EQ(site.ask(early, modbus_test::kUnit, "03 0064 0001"), "03 02 0000");
  EXPECT_EQ(site.server().port(1), passed.port);
  EXPECT_EQ(site.noticed("info: Modbus: 127.0.0.3:" + std::to_string(passed.port) +
                         ": listening on the socket that the service manager passed"),
            1U);
  EXPECT_EQ(site.ask("03 0064 0001"), "03 02 0000") << "an entry without one is bound";
  EXPECT_EQ(site.noticed("warning: "), 0U);
  site.stop_server();
  EXPECT_FALSE(is_open(passed.descriptor));
}

TEST(PassedSockets, OneThatNoEntryNamesIsToldAndClosed) {
  const Bound passed = bound("127.0.0.3");
  config::Model model = example_model();
  model.modbus->listen = {{"127.0.0.1", 0}, {"127.0.0.4", passed.port}};
  const Site site(model, {passed.descriptor});
  EXPECT_EQ(site.noticed("warning: Modbus: 127.0.0.3:" + std::to_string(passed.port) +
                         ": the service manager passed a socket for it, but [modbus] listen has no entry"),
            1U);
  EXPECT_FALSE(is_open(passed.descriptor));
  EXPECT_FALSE(TcpClient(passed.port, "127.0.0.3").connected());
}

TEST(PassedSockets, WhatIsNoListeningTcpSocketIsToldAndClosed) {
  const Bound datagrams = bound("127.0.0.3", SOCK_DGRAM);
  const Site site(example_model(), {datagrams.descriptor});
  EXPECT_EQ(site.noticed("warning: Modbus: descriptor " + std::to_string(datagrams.descriptor) +
                         ": the service manager passed it, but it is no listening TCP socket"),
            1U);
  // Its number may be another one's by now, but its port is free.
  ::close(bound("127.0.0.3", SOCK_DGRAM, datagrams.port).descriptor);
}

}  // namespace
