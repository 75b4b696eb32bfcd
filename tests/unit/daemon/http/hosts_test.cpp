#include "daemon/http/hosts.h"

#include <gtest/gtest.h>

namespace gateway::http {
namespace {

using boost::asio::ip::make_address;

TEST(HttpHosts, AreReadWithoutTheirPort) {
  EXPECT_EQ(host_of("Line3.Example.:9464"), "line3.example");
  EXPECT_EQ(host_of("192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(host_of("[2001:DB8:0::7]:80"), "2001:db8::7");
  EXPECT_EQ(host_of("[::ffff:192.0.2.7]"), "192.0.2.7");
  EXPECT_EQ(host_of("line3:"), "line3") << "an empty port is one (RFC 3986, section 3.2.3)";
  for (const char* const bad :
       {"", ":80", "a:b", "a:123456", "[::1", "[::1]x", "[nonsense]", "a b", "a/b", "u@a", "a,b", "::1", "%6c"}) {
    EXPECT_EQ(host_of(bad), std::nullopt) << bad;
  }
}

TEST(HttpHosts, TheMachineKnowsItself) {
  const Hosts hosts({"line3.plant.example", "2001:db8::9"});
  const auto own = make_address("192.0.2.7");
  for (const char* const known :
       {"localhost", "LOCALHOST:9464", "status.localhost", "127.0.0.1:9464", "127.1.2.3", "[::1]:9464",
        "192.0.2.7:9464", "line3.plant.example:8080", "LINE3.plant.example.", "[2001:db8::9]"}) {
    EXPECT_TRUE(hosts.knows(known, own)) << known;
  }
  EXPECT_TRUE(hosts.knows("192.0.2.7", make_address("::ffff:192.0.2.7"))) << "through an IPv6 socket";
  EXPECT_TRUE(hosts.knows("[fe80::1]", make_address("fe80::1%1")));
}

TEST(HttpHosts, ADotAtTheEndOfAFurtherNameIsNoneOfIt) {
  EXPECT_TRUE(Hosts({"line3.plant.example."}).knows("line3.plant.example:9464", make_address("192.0.2.7")));
}

// A page of attacker.example that was made to resolve to our address.
TEST(HttpHosts, NobodyElseIsKnown) {
  const Hosts hosts({"line3.plant.example"});
  const auto own = make_address("127.0.0.1");
  for (const char* const foreign :
       {"attacker.example:9464", "localhost.attacker.example", "xlocalhost", "line3", "x.line3.plant.example",
        "192.0.2.8", "127.0.0.1.nip.io", "2130706433", "0x7f.1", "", "[::2]"}) {
    EXPECT_FALSE(hosts.knows(foreign, own)) << foreign;
  }
}

}  // namespace
}  // namespace gateway::http
