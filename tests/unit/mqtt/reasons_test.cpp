#include "bridges/mqtt/reasons.h"

#include <gtest/gtest.h>

namespace mqtt {
namespace {

TEST(Reasons, AreNamedAsTheStandardsNameThem) {
  EXPECT_EQ(reason_text(1), "unacceptable protocol version (0x01)");
  EXPECT_EQ(reason_text(5), "not authorized (0x05)");
  EXPECT_EQ(reason_text(0x87), "Not authorized (0x87)");
  EXPECT_EQ(reason_text(0x8B), "Server shutting down (0x8B)");
  EXPECT_EQ(reason_text(0x8E), "Session taken over (0x8E)");
  EXPECT_EQ(reason_text(6), "unknown code (0x06)");
  EXPECT_EQ(reason_text(0xFF), "unknown code (0xFF)");
}

TEST(Reasons, TellWhatDoesNotPassByItself) {
  for (const int code : {4, 5, 0x86, 0x87, 0x8A}) {
    EXPECT_TRUE(refuses_credentials(code)) << code;
  }
  for (const int code : {-1, 0, 1, 2, 3, 0x80, 0x84, 0x85, 0x88, 0x8E}) {
    EXPECT_FALSE(refuses_credentials(code)) << code;
  }
  EXPECT_TRUE(refuses_version(1));
  EXPECT_TRUE(refuses_version(0x84));
  EXPECT_FALSE(refuses_version(-1));
}

}  // namespace
}  // namespace mqtt
