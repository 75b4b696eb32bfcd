#include "config/schema/nearest.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace config {
namespace {

constexpr std::array<std::string_view, 4> kNames{"heartbeat", "heartbeat_timeout", "node", "name"};

TEST(Nearest, FindsTheNameBehindATypingMistake) {
  EXPECT_EQ(nearest("hearbeat", kNames), "heartbeat");
  EXPECT_EQ(nearest("nodes", kNames), "node");
  EXPECT_EQ(nearest("nmae", kNames), "name");
  EXPECT_EQ(nearest("heartbeat_timout", kNames), "heartbeat_timeout");
}

TEST(Nearest, NamesNoneThatIsNotNear) {
  EXPECT_TRUE(nearest("something else", kNames).empty());
  EXPECT_TRUE(nearest("foo", kNames).empty());
  EXPECT_TRUE(nearest("x", {}).empty());
  EXPECT_TRUE(nearest(std::string(100'000, 'x'), kNames).empty());
}

TEST(Nearest, FindsANameThatBeginsLikeIt) {
  EXPECT_EQ(nearest("node_identifier", kNames), "node");
  EXPECT_EQ(nearest("heart", kNames), "heartbeat");
}

}  // namespace
}  // namespace config
