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
  for (const int code : {0x89, 0x8B, 0x8D, 0x8E, 0x98, 0x9C, 0x9D, 0x9F, 0xA0}) {
    EXPECT_TRUE(spares_messages(code)) << code;
  }
  for (const int code : {-1, 0, 0x80, 0x81, 0x82, 0x83, 0x87, 0x90, 0x93, 0x95, 0x96, 0x97, 0x99, 0x9A, 0x9B}) {
    EXPECT_FALSE(spares_messages(code)) << code;
  }
  EXPECT_TRUE(refuses_version(1));
  EXPECT_TRUE(refuses_version(0x84));
  EXPECT_FALSE(refuses_version(-1));
}

}  // namespace
}  // namespace mqtt
