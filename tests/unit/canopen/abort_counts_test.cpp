#include "canopen/sdo/abort_counts.h"

#include <gtest/gtest.h>

namespace canopen {
namespace {

TEST(AbortCounts, AreByCodeAndBounded) {
  AbortCounts counts;
  counts.add(0x06020000);
  counts.add(0x06020000);
  counts.add(0);
  EXPECT_EQ(counts.by_code().at(0x06020000), 2U);
  EXPECT_EQ(counts.by_code().at(0), 1U);
  for (std::uint32_t code = 1; code <= 10'000; ++code) {
    counts.add(code);
  }
  EXPECT_EQ(counts.by_code().size(), AbortCounts::kMaxCodes + 1);
  counts.add(0x06020000);
  EXPECT_EQ(counts.by_code().at(0x06020000), 3U) << "one that is known counts on";
  EXPECT_EQ(counts.by_code().at(AbortCounts::kOther), 10'000U - (AbortCounts::kMaxCodes - 2));
}

}  // namespace
}  // namespace canopen
