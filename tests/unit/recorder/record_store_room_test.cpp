// What a RecordStore does where there is too little room, and where somebody removed some.
#include <gtest/gtest.h>

#include <cerrno>
#include <string>
#include <vector>

#include "bridges/recorder/record_store.h"
#include "tests/unit/recorder/record_bench.h"

namespace recorder {
namespace {

class RecordStoreRoom : public ::testing::Test {
 protected:
  RecordStore store(std::uint64_t keep = 1'000'000) { return {bench_.state(), keep, bench_.calls()}; }
  void fill(RecordStore& store, int count, bool first = false) {
    for (int second = 0; second < count; ++second) {
      ASSERT_EQ(store.write(record_of(second, 200, first && second == 0)), std::nullopt);
    }
  }
  static std::vector<std::string> stems(const RecordStore& store) {
    std::vector<std::string> stems;
    for (const StoredRecord& record : store.records().all()) {
      stems.push_back(record.stem);
    }
    return stems;
  }
  RecordBench bench_;
};
using Stems = std::vector<std::string>;

TEST_F(RecordStoreRoom, OldOnesGoWhereTheFileSystemIsFull) {
  RecordStore store = this->store();
  fill(store, 3, true);
  bench_.set_space({.all = 1'000'000'000, .left = RecordStore::kReserve + 100});
  EXPECT_EQ(store.write(record_of(3, 1)), std::nullopt);
  EXPECT_EQ(stems(store), (Stems{stem_of(0), stem_of(2), stem_of(3)})) << "those that came first go last";
  EXPECT_EQ(bench_.names().size(), 6U);
}

TEST_F(RecordStoreRoom, ATenthOfASmallFileSystemIsLeftToOthers) {
  RecordStore store = this->store();
  fill(store, 2);
  bench_.set_space({.all = 10'000'000, .left = 1'020'000});
  EXPECT_EQ(store.write(record_of(2, 1)), std::nullopt);
  EXPECT_EQ(store.records().all().size(), 3U);
  bench_.set_space({.all = 10'000'000, .left = 1'000'000});
  EXPECT_EQ(store.write(record_of(3, 1)), std::nullopt);
  EXPECT_EQ(stems(store), (Stems{stem_of(1), stem_of(2), stem_of(3)}));
}

TEST_F(RecordStoreRoom, NoneGoesWhereThatIsNotEnough) {
  RecordStore store = this->store();
  fill(store, 3);
  bench_.set_space({.all = 1'000'000'000, .left = 1'000'000});
  const Failure failure = store.write(record_of(3));
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find("is full, but for what is left to the journal and the alarms"), std::string::npos);
  EXPECT_EQ(store.records().all().size(), 3U);
  EXPECT_EQ(bench_.names().size(), 6U);
}

TEST_F(RecordStoreRoom, AQuotaThatIsUsedUpMakesAnOldOneGoAtOnce) {
  RecordStore store = this->store();
  fill(store, 3);
  bench_.refuse(RecordBench::Call::write, EDQUOT);
  bench_.accept_when_removed();
  EXPECT_EQ(store.write(record_of(3, 1)), std::nullopt);
  EXPECT_EQ(stems(store), (Stems{stem_of(1), stem_of(2), stem_of(3)}));
}

TEST_F(RecordStoreRoom, WhereOthersFillTheDiskNotAllOfThemGo) {
  RecordStore store = this->store();
  fill(store, 4);
  bench_.refuse(RecordBench::Call::write, ENOSPC);
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(store.write(record_of(4, 1)));
  }
  EXPECT_EQ(stems(store), (Stems{stem_of(1), stem_of(2), stem_of(3)}));
}

TEST_F(RecordStoreRoom, OneThatCannotBeRemovedStaysListedAndIsTold) {
  {
    RecordStore store = this->store(20'000);
    fill(store, 2);
    bench_.refuse(RecordBench::Call::remove, EIO);
    EXPECT_EQ(store.write(record_of(2, 200)), std::nullopt) << "the new one is not lost for that";
    EXPECT_EQ(store.records().all().size(), 3U);
  }
  RecordStore again = store(15'000);
  const Failure failure = again.open();
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find("cannot remove an old record"), std::string::npos);
  EXPECT_EQ(again.records().all().size(), 3U);
  EXPECT_TRUE(again.is_open());
}

TEST_F(RecordStoreRoom, WhereLessMayBeKeptThanBeforeTheOldestGoAtTheStart) {
  {
    RecordStore store = this->store();
    fill(store, 4);
  }
  RecordStore again = store(15'000);
  ASSERT_EQ(again.open(), std::nullopt);
  EXPECT_EQ(stems(again), Stems{stem_of(3)});
  EXPECT_LE(again.records().size(), 15'000U);
}

TEST_F(RecordStoreRoom, NoOldOneGoesForANewOneThatDoesNotComeToBe) {
  RecordStore store = this->store(15'000);
  fill(store, 1);
  bench_.refuse(RecordBench::Call::rename, EIO);
  EXPECT_TRUE(store.write(record_of(1, 200)));
  EXPECT_EQ(stems(store), Stems{stem_of(0)});
}

TEST_F(RecordStoreRoom, WhatAPersonRemovedIsListedNoMore) {
  RecordStore store = this->store();
  fill(store, 4);
  std::filesystem::remove(bench_.records() / (stem_of(0) + ".log"));
  std::filesystem::remove(bench_.records() / (stem_of(1) + ".json"));
  std::filesystem::remove(bench_.records() / (stem_of(2) + ".log"));
  std::filesystem::remove(bench_.records() / (stem_of(2) + ".json"));
  ASSERT_EQ(store.write(record_of(4, 1)), std::nullopt);
  EXPECT_EQ(stems(store), (Stems{stem_of(1), stem_of(3), stem_of(4)}));
  EXPECT_EQ(store.records().find(stem_of(1))->json_size, 0U);
  EXPECT_EQ(store.records().find(stem_of(3))->summary, (RecordSummary{"can0", "pump1", false, 200, 1}));
  EXPECT_EQ(bench_.names().size(), 5U) << "the JSON goes with its log";
}

TEST_F(RecordStoreRoom, AJsonThatIsNoneOfOursIsLeft) {
  bench_.put(stem_of(0) + ".json", "{}");
  bench_.put("notes.json", "{}");
  RecordStore store = this->store();
  ASSERT_EQ(store.open(), std::nullopt);
  EXPECT_EQ(bench_.names().size(), 2U);
}

}  // namespace
}  // namespace recorder
