#include <gtest/gtest.h>

#include "tests/rooms/include_rules.h"

namespace rooms {
namespace {

TEST(Rooms, EveryIncludeKeepsToTheRules) {
  std::size_t files_read = 0;
  for (const Violation& violation : check_tree(GATEWAY_SOURCE_DIR, files_read)) {
    ADD_FAILURE() << to_string(violation);
  }
  EXPECT_GT(files_read, room_names().size());
}

}  // namespace
}  // namespace rooms
