#include "bridges/recorder/record_store.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cerrno>
#include <string>
#include <vector>

#include "tests/unit/recorder/record_bench.h"

namespace recorder {
namespace {

using Call = RecordBench::Call;
using Names = std::vector<std::string>;

Names both(std::initializer_list<int> seconds) {
  Names names;
  for (const int second : seconds) {
    names.push_back(stem_of(second) + ".json");
    names.push_back(stem_of(second) + ".log");
  }
  std::ranges::sort(names);
  return names;
}

class RecordStoreTest : public ::testing::Test {
 protected:
  RecordStore store(std::uint64_t keep = 1'000'000) { return {bench_.state(), keep, bench_.calls()}; }
  RecordBench bench_;
};

TEST_F(RecordStoreTest, WritesTheLogAndWhatHappenedBesideIt) {
  RecordStore store = this->store();
  EXPECT_EQ(store.write(record_of(0)), std::nullopt);
  EXPECT_EQ(bench_.names(), both({0}));
  EXPECT_EQ(bench_.text_of(stem_of(0) + ".log"),
            "(1767323045.000000) can0 185#00\n"
            "(1767323046.000000) can0 185#01\n"
            "(1767323047.000000) can0 185#02\n");
  EXPECT_EQ(parse_summary(bench_.text_of(stem_of(0) + ".json")), (RecordSummary{"can0", "pump1", false, 3, 1}));
  ASSERT_EQ(store.records().all().size(), 1U);
  EXPECT_EQ(store.records().all()[0].log_size, 96U);
}

TEST_F(RecordStoreTest, WhatIsThereIsListedAtTheNextStart) {
  Names listed;
  {
    RecordStore store = this->store();
    ASSERT_EQ(store.write(record_of(5)), std::nullopt);
    ASSERT_EQ(store.write(record_of(0, 3, true)), std::nullopt);
  }
  RecordStore again = store();
  ASSERT_EQ(again.open(), std::nullopt);
  const auto& records = again.records().all();
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].stem, stem_of(0));
  EXPECT_EQ(records[0].summary, (RecordSummary{"can0", "pump1", true, 3, 1}));
  EXPECT_EQ(records[1].stem, stem_of(5));
}

TEST_F(RecordStoreTest, RemovesWhatACrashLeftAndNothingElse) {
  const std::string stem = stem_of(0);
  for (const std::string& name : {stem + ".log.new", stem + ".json.new", std::string("notes.new"),
                                  std::string("trace.log"), stem + ".log.bak", std::string("x") + stem + ".log.new"}) {
    bench_.put(name, "x");
  }
  std::filesystem::create_directory(bench_.records() / (stem_of(9) + ".log"));
  std::filesystem::create_symlink("/etc/passwd", bench_.records() / (stem_of(8) + ".log"));
  RecordStore store = this->store();
  ASSERT_EQ(store.open(), std::nullopt);
  EXPECT_EQ(bench_.names(), (Names{stem + ".log.bak", stem_of(8) + ".log", stem_of(9) + ".log", "notes.new",
                                   "trace.log", "x" + stem + ".log.new"}));
  EXPECT_TRUE(store.records().all().empty());
}

TEST_F(RecordStoreTest, ALogWithoutItsJsonIsARecord) {
  bench_.put(stem_of(0) + ".log", "(1.000000) can0 185#00\n");
  bench_.put(stem_of(1) + ".log", "");
  bench_.put(stem_of(1) + ".json", "no JSON");
  RecordStore store = this->store();
  ASSERT_EQ(store.open(), std::nullopt);
  ASSERT_EQ(store.records().all().size(), 2U);
  EXPECT_EQ(store.records().all()[0].json_size, 0U);
  EXPECT_EQ(store.records().all()[1].summary, RecordSummary{});
}

TEST_F(RecordStoreTest, TheOldestGoWhereAllAreTooMuch) {
  RecordStore store = this->store(8000);
  for (int second = 0; second < 20; ++second) {
    ASSERT_EQ(store.write(record_of(second, 60)), std::nullopt);
    EXPECT_LE(store.records().size(), 8000U);
  }
  ASSERT_GE(store.records().all().size(), 2U);
  EXPECT_EQ(store.records().all().back().stem, stem_of(19));
  EXPECT_EQ(bench_.names().size(), 2 * store.records().all().size());
}

TEST_F(RecordStoreTest, ThoseThatCameFirstGoLast) {
  RecordStore store = this->store(8000);
  ASSERT_EQ(store.write(record_of(0, 60, true)), std::nullopt);
  for (int second = 1; second < 20; ++second) {
    ASSERT_EQ(store.write(record_of(second, 60)), std::nullopt);
  }
  EXPECT_EQ(store.records().all().front().stem, stem_of(0));
  EXPECT_EQ(store.records().all().back().stem, stem_of(19));
  for (int second = 20; second < 40; ++second) {
    ASSERT_EQ(store.write(record_of(second, 60, true)), std::nullopt);
  }
  EXPECT_NE(store.records().all().front().stem, stem_of(0)) << "where all came first, the oldest goes";
}

TEST_F(RecordStoreTest, NoLogIsLongerThanHalfOfWhatAllMayTake) {
  RecordStore store = this->store(8000);
  ASSERT_EQ(store.write(record_of(0, 500)), std::nullopt);
  EXPECT_LE(store.records().all().at(0).log_size, 4000U);
  EXPECT_NE(bench_.text_of(stem_of(0) + ".json").find("\"shortened\":true"), std::string::npos);
}

TEST_F(RecordStoreTest, ADiskThatRefusesLeavesNothingHalf) {
  RecordStore store = this->store();
  for (const auto& [call, error, taken] : {std::tuple{Call::write, ENOSPC, 40UL},
                                           {Call::write, EROFS, 0UL},
                                           {Call::sync, EIO, 0UL},
                                           {Call::rename, ENOSPC, 0UL}}) {
    bench_.refuse(call, error, taken);
    const Failure failure = store.write(record_of(0));
    ASSERT_TRUE(failure);
    EXPECT_NE(failure->find(std::generic_category().message(error)), std::string::npos) << *failure;
    EXPECT_EQ(bench_.names(), Names{});
    EXPECT_TRUE(store.records().all().empty());
  }
  bench_.accept();
  EXPECT_EQ(store.write(record_of(0)), std::nullopt);
  EXPECT_EQ(bench_.names(), both({0}));
}

TEST_F(RecordStoreTest, ADirectoryThatWasRemovedIsMadeAgain) {
  RecordStore store = this->store();
  ASSERT_EQ(store.write(record_of(0)), std::nullopt);
  std::filesystem::remove_all(bench_.state());
  EXPECT_EQ(store.write(record_of(1)), std::nullopt);
  EXPECT_EQ(bench_.names(), both({1}));
  EXPECT_EQ(store.records().all().size(), 1U);
}

TEST_F(RecordStoreTest, TellsThatAnotherProcessHasTheDirectory) {
  RecordStore one = store();
  ASSERT_EQ(one.open(), std::nullopt);
  RecordStore other = store();
  const Failure failure = other.write(record_of(0));
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find("in use by another process"), std::string::npos);
  EXPECT_FALSE(other.is_open());
  EXPECT_EQ(bench_.names(), Names{});
}

TEST_F(RecordStoreTest, AFileInPlaceOfTheDirectoryIsTold) {
  std::filesystem::create_directory(bench_.state());
  std::ofstream(bench_.records()) << "x";
  RecordStore store = this->store();
  const Failure failure = store.open();
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find("Not a directory"), std::string::npos) << *failure;
}

TEST_F(RecordStoreTest, ThereAreNeverMoreThanAThousand) {
  for (int second = 0; second < 1004; ++second) {
    bench_.put(stem_of(second) + ".log", "");
  }
  RecordStore store = this->store(1'000'000'000);
  ASSERT_EQ(store.write(record_of(1004, 1)), std::nullopt);
  EXPECT_EQ(store.records().all().size(), StoredRecords::kMost);
  EXPECT_EQ(store.records().all().front().stem, stem_of(5));
}

}  // namespace
}  // namespace recorder
