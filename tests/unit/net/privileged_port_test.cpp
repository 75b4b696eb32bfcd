#include "bridges/net/privileged_port.h"

#include <gmock/gmock.h>

namespace net {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(PrivilegedPort, WhatThePackagedSocketHasNeedsNoMoreThanThat) {
  const std::string remedy = privileged_port_remedy({"0.0.0.0", 502}, true);
  EXPECT_THAT(remedy, HasSubstr("`systemctl enable canopen-gateway.socket`, then restart"));
  EXPECT_THAT(remedy, HasSubstr("where it is enabled and was edited, add ListenStream=0.0.0.0:502 to it"));
}

TEST(PrivilegedPort, AnotherAddressIsSaidToTheSocketUnitToTheLetter) {
  EXPECT_THAT(privileged_port_remedy({"127.0.0.1", 502}, true),
              HasSubstr("canopen-gateway.socket has 0.0.0.0:502: write that in `listen`"));
  EXPECT_THAT(privileged_port_remedy({"127.0.0.1", 502}, true),
              HasSubstr("ListenStream=127.0.0.1:502, each in a line"));
  EXPECT_THAT(privileged_port_remedy({"::1", 503}, true), HasSubstr("ListenStream=[::1]:503, each in a line"));
}

TEST(PrivilegedPort, ANameIsNoAddressThatSystemdPasses) {
  EXPECT_THAT(privileged_port_remedy({"localhost", 502}, true),
              HasSubstr("numeric address only: write one for localhost"));
}

TEST(PrivilegedPort, WhatIsNotPassedNeedsAnotherPort) {
  EXPECT_THAT(privileged_port_remedy({"0.0.0.0", 80}, false), HasSubstr("privileged-port.conf"));
  EXPECT_THAT(privileged_port_remedy({"0.0.0.0", 80}, false), Not(HasSubstr("canopen-gateway.socket")));
}

}  // namespace
}  // namespace net
