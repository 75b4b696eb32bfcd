// Listeners that cannot open their address at the start.

#include <arpa/inet.h>
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <bit>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "tests/unit/modbus/site.h"

namespace {

/// Names of which the system has nothing to tell for long.
struct SlowNames {
  std::mutex mutex;
  std::condition_variable changed;
  bool held = false;  ///< Nobody is answered.
  int asking = 0;
};
SlowNames slow_names;

}  // namespace

// Before that of the system, of which a test must not wait for a name server.
extern "C" int getaddrinfo(const char* name, const char* service, const addrinfo* hints, addrinfo** found) {
  const std::string_view asked(name == nullptr ? "" : name);
  if (asked == "no-such-host.invalid") {
    return EAI_NONAME;
  }
  if (asked == "slow.invalid") {
    std::unique_lock lock(slow_names.mutex);
    ++slow_names.asking;
    slow_names.changed.notify_all();
    // A test that fails must end, too.
    slow_names.changed.wait_for(lock, std::chrono::seconds(10), [] { return !slow_names.held; });
    --slow_names.asking;
    slow_names.changed.notify_all();
    return EAI_AGAIN;
  }
  using GetAddrInfo = int (*)(const char*, const char*, const addrinfo*, addrinfo**);
  return std::bit_cast<GetAddrInfo>(::dlsym(RTLD_NEXT, "getaddrinfo"))(name, service, hints, found);
}

namespace {

using modbus_test::example_model;
using modbus_test::kUnit;
using modbus_test::Site;
using modbus_test::TcpClient;
using std::chrono::seconds;

/// A port of 127.0.0.1 on which somebody else listens.
class Squatter {
 public:
  Squatter() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const any = std::bit_cast<sockaddr*>(&address);
    const int on = 1;
    EXPECT_EQ(::setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on), 0);
    EXPECT_EQ(::bind(socket_, any, size), 0);
    EXPECT_EQ(::listen(socket_, 1), 0);
    EXPECT_EQ(::getsockname(socket_, any, &size), 0);
    port_ = ntohs(address.sin_port);
  }
  ~Squatter() { ::close(socket_); }
  Squatter(const Squatter&) = delete;
  Squatter& operator=(const Squatter&) = delete;
  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }

 private:
  int socket_;
  std::uint16_t port_ = 0;
};

config::Model listening_on(std::vector<config::Endpoint> endpoints) {
  config::Model model = example_model();
  model.modbus->listen = std::move(endpoints);
  return model;
}

TEST(LateListening, ATakenPortIsServedOnceItIsFree) {
  std::optional<Squatter> squatter(std::in_place);
  const std::uint16_t port = squatter->port();
  Site site(listening_on({{"127.0.0.1", port}, {"127.0.0.2", port}}));
  const std::string name = "Modbus: 127.0.0.1:" + std::to_string(port) + ": ";
  EXPECT_EQ(site.noticed("warning: " + name + "cannot listen: Address already in use; another program"), 1U);
  EXPECT_EQ(site.port(), 0);
  TcpClient other(port, "127.0.0.2");
  EXPECT_EQ(site.ask(other, kUnit, "03 0064 0001"), "03 02 0000") << "the other entry is served";
  site.loop().advance(seconds(100), seconds(1));
  EXPECT_EQ(site.noticed("cannot listen"), 1U) << "told once";
  squatter.reset();
  // Tried after 1, 3, 7, 15, 31, 61, 91, 121 s.
  site.loop().advance(seconds(20), seconds(1));
  EXPECT_EQ(site.port(), 0);
  site.loop().advance(seconds(1), seconds(1));
  EXPECT_EQ(site.port(), port);
  EXPECT_EQ(site.noticed("info: " + name + "listening"), 1U);
  EXPECT_EQ(site.ask("03 0064 0001"), "03 02 0000");
}

TEST(LateListening, IsTriedAgainAfterOneSecond) {
  std::optional<Squatter> squatter(std::in_place);
  Site site(listening_on({{"127.0.0.1", squatter->port()}}));
  squatter.reset();
  site.loop().advance(std::chrono::milliseconds(990));
  EXPECT_EQ(site.port(), 0);
  site.loop().advance(std::chrono::milliseconds(10));
  EXPECT_NE(site.port(), 0);
}

TEST(LateListening, AnAddressThatThisMachineLacksIsTakenForWhenItHasIt) {
  for (const char* const host : {"192.0.2.1", "2001:db8::1"}) {  // for documents only: RFC 5737, RFC 3849
    Site site(listening_on({{host, 0}}));
    EXPECT_NE(site.port(), 0) << host;
    EXPECT_EQ(site.noticed("warning: "), 1U) << host;
    EXPECT_EQ(site.noticed("this machine does not have the address"), 1U) << host;
  }
}

TEST(LateListening, ANameThatNobodyKnowsIsToldOnceAndKeepsNothingBack) {
  Site site(listening_on({{"no-such-host.invalid", 1502}, {"127.0.0.1", 0}}));
  TcpClient client(site.server().port(1));
  EXPECT_EQ(site.ask(client, kUnit, "03 0064 0001"), "03 02 0000");
  EXPECT_TRUE(site.settle_until([&site] { return site.noticed("no-such-host.invalid:1502: cannot listen: ") == 1; }));
  EXPECT_EQ(site.noticed("the name must be known here"), 1U);
  site.loop().advance(seconds(1), seconds(1));
  site.stop_server();  // though the system may still be looking for that name
}

TEST(LateListening, EndsWhileTheSystemLooksForAName) {
  slow_names.held = true;
  auto site = std::make_unique<Site>(listening_on({{"slow.invalid", 1502}}));
  {
    std::unique_lock lock(slow_names.mutex);
    EXPECT_TRUE(slow_names.changed.wait_for(lock, seconds(5), [] { return slow_names.asking == 1; }));
  }
  site->stop_server();
  site.reset();  // and its loop
  std::unique_lock lock(slow_names.mutex);
  EXPECT_EQ(slow_names.asking, 1) << "nobody waited for the system";
  slow_names.held = false;
  slow_names.changed.notify_all();
  EXPECT_TRUE(slow_names.changed.wait_for(lock, seconds(5), [] { return slow_names.asking == 0; }));
}

TEST(LateListening, EndsWhileItWaitsToTryAgain) {
  const Squatter squatter;
  Site site(listening_on({{"127.0.0.1", squatter.port()}}));
  site.loop().advance(seconds(10), seconds(1));
  const canopen::TimePoint before = canopen::Clock::now();
  site.stop_server();
  EXPECT_LE(canopen::Clock::now() - before, std::chrono::milliseconds(1));
}

}  // namespace
