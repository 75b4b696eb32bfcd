#include "bridges/mqtt/line.h"

#include <gtest/gtest.h>

namespace mqtt {
namespace {

TEST(Line, WhatComesInBulkCostsNoCommandItsPlaceUntilItIsGivenBack) {
  Line line;
  line.orders = {{.subscription = {.filter = "a/#", .bulk = true}}, {.subscription = {.filter = "c/+"}}};
  EXPECT_EQ(line.take_orders().size(), 2U);
  EXPECT_TRUE(line.is_watched("a/b"));
  EXPECT_FALSE(line.is_watched("c/d"));
  line.orders = {{.subscription = {.filter = "a/#"}, .ends = true}};
  EXPECT_EQ(line.take_orders().size(), 1U);
  EXPECT_FALSE(line.is_watched("a/b"));
}

TEST(Line, BehindASuspectedTakeOverItIsNotTriedAgainAtOnce) {
  Line line;
  for (const bool suspected : {false, true}) {
    line.begin();
    line.up({});
    line.suspects_takeover = suspected;
    line.down(-1);
    EXPECT_EQ(line.end("id").stays, suspected);
  }
  line.begin();
  EXPECT_FALSE(line.suspects_takeover) << "of that connection only";
}

TEST(Line, OneThatWasGivenUpIsNoneWhenItComesAboutAfterAll) {
  Line line;
  line.begin();
  line.give_up();
  line.up({});
  EXPECT_FALSE(line.stood());
  line.begin();
  line.up({});
  line.give_up();
  EXPECT_TRUE(line.is_up()) << "it came just in time";
}

TEST(Line, TellsABrokerThatIsSilentFromOneThatIsLeft) {
  Line line;
  line.begin();
  line.up({});
  line.stalled = true;
  EXPECT_TRUE(line.end("id").silent);
  EXPECT_FALSE(line.end("id").left);
  line.begin();
  line.up({});
  line.leave_by.emplace();
  EXPECT_TRUE(line.end("id").left);
  EXPECT_FALSE(line.end("id").silent);
  EXPECT_FALSE(line.end("id").unexplained) << "what is under way is no reason";
}

}  // namespace
}  // namespace mqtt
