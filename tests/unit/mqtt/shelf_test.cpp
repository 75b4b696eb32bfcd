#include "bridges/mqtt/shelf.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace mqtt {
namespace {

void put(Shelf& shelf, const std::string& key, const std::vector<std::string>& parts) {
  shelf.put(key, {parts.begin(), parts.end()});
}

TEST(Shelf, GivesBackWhatWasPutThereInOnePiece) {
  Shelf shelf;
  const std::string binary("\0\xFF", 2);
  put(shelf, "s-1", {"head", "", binary, "payload"});
  EXPECT_TRUE(shelf.contains_key("s-1"));
  EXPECT_EQ(shelf.get("s-1"), "head" + binary + "payload");
  put(shelf, "s-1", {"newer"});
  EXPECT_EQ(shelf.get("s-1"), "newer");
  put(shelf, "s-2", {});
  EXPECT_EQ(shelf.get("s-2"), "");
}

TEST(Shelf, KnowsWhatIsThere) {
  Shelf shelf;
  shelf.open("client", "tcp://192.0.2.1:1883");
  EXPECT_EQ(shelf.keys().size(), 0U);
  put(shelf, "s-2", {"b"});
  put(shelf, "s-1", {"a"});
  const string_collection keys = shelf.keys();
  ASSERT_EQ(keys.size(), 2U);
  EXPECT_EQ(keys[0], "s-1");
  EXPECT_EQ(keys[1], "s-2");
  shelf.remove("s-1");
  shelf.remove("s-1");
  EXPECT_FALSE(shelf.contains_key("s-1"));
  EXPECT_THROW((void)shelf.get("s-1"), persistence_exception);
  EXPECT_EQ(shelf.get("s-2"), "b");
}

TEST(Shelf, IsEmptyBehindClearAndClose) {
  Shelf shelf;
  put(shelf, "s-1", {"a"});
  shelf.clear();
  EXPECT_EQ(shelf.keys().size(), 0U);
  put(shelf, "s-1", {"a"});
  shelf.close();
  EXPECT_EQ(shelf.keys().size(), 0U) << "nothing outlives the client";
}

}  // namespace
}  // namespace mqtt
