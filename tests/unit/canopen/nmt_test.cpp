#include "canopen/nmt.h"

#include <gtest/gtest.h>

namespace canopen {
namespace {

TEST(Nmt, CommandNamesAndNumbers) {
  for (const std::uint64_t number : {1U, 2U, 128U, 129U, 130U}) {
    const auto command = nmt_command_of(number);
    ASSERT_TRUE(command) << number;
    EXPECT_EQ(parse_nmt_command(name_of(*command)), command);
  }
  EXPECT_EQ(parse_nmt_command("reset-node"), NmtCommand::reset_node);
}

TEST(Nmt, NoOtherCommandExists) {
  for (const std::uint64_t number : {0ULL, 3ULL, 127ULL, 131ULL, 257ULL, 0x100000001ULL}) {
    EXPECT_EQ(nmt_command_of(number), std::nullopt) << number;
  }
  EXPECT_EQ(parse_nmt_command("Start"), std::nullopt);
  EXPECT_EQ(parse_nmt_command(""), std::nullopt);
}

TEST(Nmt, StateNames) {
  EXPECT_EQ(name_of(NmtState::pre_operational), "pre-operational");
  EXPECT_EQ(name_of(NmtState::operational), "operational");
  EXPECT_EQ(name_of(static_cast<NmtState>(9)), "unknown");
}

}  // namespace
}  // namespace canopen
