#include "bridges/recorder/stored_records.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/recorder/record_bench.h"

namespace recorder {
namespace {

/// A name that counts what it is compared with.
struct CountedName {
  std::string text;
  int* compared;
};
bool operator<(const std::string& stem, const CountedName& name) {
  ++*name.compared;
  return stem < name.text;
}
bool operator==(const std::string& stem, const CountedName& name) {
  ++*name.compared;
  return stem == name.text;
}

// The loop looks for each alarm that names a record, 635 of them on a bus that is full, after each write.
TEST(StoredRecordsList, FindsOneOfAThousandByFewComparisons) {
  StoredRecords records;
  for (int second = 999; second >= 0; --second) {
    records.add({.name = {wall_at(second * 2), "pump1", "emcy"}});
  }
  int compared = 0;
  for (int second = 0; second < 1000; ++second) {
    const StoredRecord* const record = records.find(CountedName{stem_of(second * 2), &compared});
    ASSERT_NE(record, nullptr);
    EXPECT_EQ(record->stem, stem_of(second * 2));
    EXPECT_EQ(records.find(CountedName{stem_of(second * 2 + 1), &compared}), nullptr);
  }
  EXPECT_LE(compared, 2000 * 11);
}

TEST(StoredRecordsList, IsInTheOrderOfTimeAndHasOneOfEachName) {
  StoredRecords records;
  for (const int second : {5, 3, 9, 3}) {
    records.add({.name = {wall_at(second), "pump1", "emcy"}, .log_size = 10});
  }
  records.remove(stem_of(9));
  records.remove(stem_of(8));
  ASSERT_EQ(records.all().size(), 2U);
  EXPECT_EQ(records.all()[0].stem, stem_of(3));
  EXPECT_EQ(records.all()[1].stem, stem_of(5));
  EXPECT_EQ(records.size(), 20U);
}

}  // namespace
}  // namespace recorder
