// Connections that come when the process has no descriptor left.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::example_model;
using modbus_test::frame;
using modbus_test::kUnit;
using modbus_test::Site;
using modbus_test::TcpClient;

/// From here on no descriptor can be opened.
class NoDescriptors {
 public:
  NoDescriptors() {
    EXPECT_EQ(::getrlimit(RLIMIT_NOFILE, &before_), 0);
    const int next = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    ::close(next);
    rlimit none = before_;
    none.rlim_cur = static_cast<rlim_t>(next);
    EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  }
  ~NoDescriptors() { EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &before_), 0); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_{};
};

bool was_closed(Site& site, TcpClient& client) {
  return site.settle_until([&client] {
    client.receive();
    return client.closed();
  });
}

TEST(NoDescriptorsLeft, WhoConnectsIsRefusedAtOnceAndWhatHeSentIsNeverCarriedOut) {
  Site site;
  site.bring_up();
  TcpClient before(site.port());
  EXPECT_EQ(site.ask(before, kUnit, "03 0064 0001"), "03 02 0000");
  TcpClient late(site.port());
  TcpClient another(site.port());
  const auto write = frame(kUnit, "06 012c 0001");
  ASSERT_EQ(late.send(write), write.size());
  {
    const NoDescriptors none;
    EXPECT_TRUE(was_closed(site, late));
    EXPECT_TRUE(was_closed(site, another));
    EXPECT_EQ(site.ask(before, kUnit, "03 0064 0001"), "03 02 0000");
  }
  EXPECT_EQ(site.server().refused(), 2U);
  EXPECT_EQ(site.noticed("no descriptor is left (Too many open files)"), 1U);
  EXPECT_EQ(site.noticed("127.0.0.1: refused: no descriptor is left"), 1U);
  site.run(std::chrono::seconds(1));
  EXPECT_TRUE(site.puppet().written.empty());
  TcpClient afterwards(site.port());
  EXPECT_EQ(site.ask(afterwards, kUnit, "03 0064 0001"), "03 02 0000");
}

TEST(NoDescriptorsLeft, WhoMayWriteTakesThePlaceOfAStranger) {
  config::Model model = example_model();
  model.modbus->write_from = {{"127.0.0.9", 32}};
  Site site(model);
  TcpClient stranger(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.2");
  EXPECT_EQ(site.ask(stranger, kUnit, "03 0064 0001"), "03 02 0000");
  TcpClient scada(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.9");
  const NoDescriptors none;
  EXPECT_EQ(site.ask(scada, kUnit, "03 0064 0001"), "03 02 0000");
  EXPECT_TRUE(was_closed(site, stranger));
  EXPECT_EQ(site.noticed("127.0.0.2: disconnected: made room for a client of write_from"), 1U);
}

}  // namespace
