#include "bridges/journal/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "bridges/journal/verify.h"
#include "tests/unit/journal/disk.h"

namespace journal {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Optional;
using testing::SizeIs;

class JournalStore : public testing::Test {
 protected:
  [[nodiscard]] Store open(std::uint64_t limit = 1'000'000) {
    return Store(directory_.journal(), limit, disk_.calls());
  }
  [[nodiscard]] Report report() const {
    std::error_code failure;
    return verify(directory_.journal(), failure);
  }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return directory_.journal() / name; }
  [[nodiscard]] std::uint64_t bytes() const {
    std::uint64_t all = 0;
    std::error_code failure;
    for (const File& each : list_files(directory_.journal(), failure)) {
      all += each.size;
    }
    return all;
  }

  TemporaryDirectory directory_;
  Disk disk_;
};

TEST_F(JournalStore, GoesOnOverDaysAndRestarts) {
  for (int day = 1; day <= 3; ++day) {
    Store store = open();
    EXPECT_FALSE(store.append(entry_at(day, 1)));
    EXPECT_FALSE(store.append(entry_at(day, 2)));
    EXPECT_EQ(store.newest_hash(), report().newest_hash);
  }
  EXPECT_THAT(names_in(directory_.journal()), ElementsAre("2026-01-01.jsonl", "2026-01-02.jsonl", "2026-01-03.jsonl"));
  EXPECT_TRUE(report().sound()) << report().broken;
  EXPECT_EQ(report().newest, 6U);
  EXPECT_EQ(parse_line(lines_of(file("2026-01-01.jsonl")).at(0))->prev, kNoHash);
}

TEST_F(JournalStore, KnowsItsNewestHashBeforeTheFirstLine) {
  std::string hash;
  {
    Store store = open();
    ASSERT_FALSE(store.append(entry_at(1)));
    hash = store.newest_hash();
  }
  Store store = open();
  EXPECT_EQ(store.newest_hash(), "");
  EXPECT_FALSE(store.open(entry_at(1)));
  EXPECT_EQ(store.newest_hash(), hash);
}

TEST_F(JournalStore, IsForNobodyElse) {
  Store store = open();
  ASSERT_FALSE(store.append(entry_at(1)));
  struct stat status{};
  ASSERT_EQ(stat(directory_.journal().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0027U, 0U);
  ASSERT_EQ(stat(file("2026-01-01.jsonl").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0137U, 0U);
}

TEST_F(JournalStore, ASecondProcessIsToldSoAndWritesNothing) {
  std::optional<Store> first(std::in_place, directory_.journal(), 1'000'000, disk_.calls());
  ASSERT_FALSE(first->append(entry_at(1)));
  Store second = open();
  EXPECT_THAT(second.append(entry_at(1)), Optional(HasSubstr("in use by another process")));
  EXPECT_EQ(report().lines, 1U);
  first.reset();
  EXPECT_FALSE(second.append(entry_at(1)));
  EXPECT_EQ(report().lines, 2U);
}

TEST_F(JournalStore, WithoutADirectoryItSaysWhy) {
  Store store(directory_.path() / "no" / "such" / "journal", 1'000'000, disk_.calls());
  EXPECT_THAT(store.append(entry_at(1)), Optional(EndsWith("/no/such: No such file or directory")));
  set_text(directory_.path() / "file", "");
  Store on_file(directory_.path() / "file" / "journal", 1'000'000, disk_.calls());
  EXPECT_THAT(on_file.append(entry_at(1)), Optional(HasSubstr("Not a directory")));
}

TEST_F(JournalStore, ALineThatDidNotFitOnTheDiskLeavesNoTrace) {
  Store store = open();
  ASSERT_FALSE(store.append(entry_at(1, 1)));
  disk_.refuse(ENOSPC, 30);
  EXPECT_THAT(store.append(entry_at(1, 2)), Optional(HasSubstr("No space left on device")));
  EXPECT_THAT(lines_of(file("2026-01-01.jsonl")), SizeIs(1));
  EXPECT_THAT(text_of(file("2026-01-01.jsonl")), EndsWith("\n"));
  disk_.accept();
  EXPECT_FALSE(store.append(entry_at(1, 3)));
  EXPECT_TRUE(report().sound()) << report().broken;
  EXPECT_THAT(report().remarks, testing::IsEmpty());
  EXPECT_EQ(report().newest, 2U);
}

TEST_F(JournalStore, WritesThatTakeAPartAreGoneOnWith) {
  FileCalls calls = FileCalls::real();
  calls.write = [](int descriptor, const char* bytes, std::size_t size) {
    return ::write(descriptor, bytes, std::min<std::size_t>(size, 7));
  };
  Store store(directory_.journal(), 1'000'000, calls);
  EXPECT_FALSE(store.append(entry_at(1)));
  EXPECT_FALSE(store.append(entry_at(1)));
  EXPECT_TRUE(report().sound()) << report().broken;
  EXPECT_EQ(report().newest, 2U);
}

TEST_F(JournalStore, EveryCutOfTheLastLineIsSurvived) {
  std::string whole;
  {
    Store store = open();
    ASSERT_FALSE(store.append(entry_at(1, 1)));
    ASSERT_FALSE(store.append(entry_at(1, 2)));
    whole = text_of(file("2026-01-01.jsonl"));
  }
  const std::size_t first = whole.find('\n') + 1;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    set_text(file("2026-01-01.jsonl"), whole.substr(0, size));
    {
      Store store = open();
      ASSERT_FALSE(store.append(entry_at(1, 3)));
    }
    const Report found = report();
    EXPECT_TRUE(found.sound()) << found.broken;
    // A line that lacks only its line break is one.
    const std::uint64_t kept = (size + 1 >= first ? 1U : 0U) + (size + 1 >= whole.size() ? 1U : 0U);
    const bool clean = size == 0 || size == first || size == first - 1 || size + 1 >= whole.size();
    EXPECT_THAT(found.remarks, SizeIs(clean ? 0 : 1)) << size;
    EXPECT_EQ(found.newest, kept + (clean ? 1 : 2)) << size;
  }
}

TEST_F(JournalStore, ATornLineIsClosedInItsOwnFileWheneverTheDiskTakesIt) {
  {
    Store store = open();
    ASSERT_FALSE(store.append(entry_at(1)));
  }
  set_text(file("2026-01-01.jsonl"), text_of(file("2026-01-01.jsonl")) + "{\"n\"");
  Store store = open();
  for (const std::size_t taken : {0U, 1U, 50U}) {
    disk_.refuse(ENOSPC, taken);
    EXPECT_TRUE(store.append(entry_at(2)));
  }
  disk_.accept();
  EXPECT_FALSE(store.append(entry_at(2)));
  EXPECT_THAT(lines_of(file("2026-01-01.jsonl")), SizeIs(3));
  EXPECT_TRUE(report().sound()) << report().broken;
  EXPECT_EQ(report().newest, 3U);
  EXPECT_EQ(report().files, 2U);
}

TEST_F(JournalStore, AnEmptyNewestFileIsNoEnd) {
  {
    Store store = open();
    ASSERT_FALSE(store.append(entry_at(1)));
  }
  set_text(file("2026-01-02.jsonl"), "");
  Store store = open();
  EXPECT_FALSE(store.append(entry_at(3)));
  EXPECT_TRUE(report().sound()) << report().broken;
  EXPECT_EQ(report().newest, 2U);
}

TEST_F(JournalStore, AllFilesTogetherKeepTheLimitAtEveryLine) {
  constexpr std::uint64_t kLimit = 20'000;
  Store store = open(kLimit);
  for (int i = 0; i < 500; ++i) {
    ASSERT_FALSE(store.append(entry_at(1 + i / 300)));
    ASSERT_LE(bytes(), kLimit);
  }
  EXPECT_GT(bytes(), kLimit * 3 / 4) << "it keeps what it can";
  EXPECT_TRUE(report().sound()) << report().broken;
  EXPECT_EQ(report().newest, 500U);
  EXPECT_THAT(report().remarks, ElementsAre(HasSubstr("older files were removed")));
  const auto names = names_in(directory_.journal());
  EXPECT_EQ(names.back(), "2026-01-02.12.jsonl");
}

TEST_F(JournalStore, ASmallerLimitCountsFromTheStart) {
  {
    Store store = open();
    for (int day = 1; day <= 20; ++day) {
      for (int i = 0; i < 10; ++i) {
        ASSERT_FALSE(store.append(entry_at(day)));
      }
    }
  }
  ASSERT_GT(bytes(), 20'000U);
  Store store = open(20'000);
  EXPECT_FALSE(store.open(entry_at(20)));
  EXPECT_LE(bytes(), 20'000U);
  EXPECT_TRUE(report().sound()) << report().broken;
}

TEST_F(JournalStore, OtherFilesOfTheDirectoryAreLeftAlone) {
  set_text(file("2026-01-01.jsonl.backup"), std::string(100'000, 'x'));
  Store store = open(20'000);
  for (int i = 0; i < 300; ++i) {
    ASSERT_FALSE(store.append(entry_at(1)));
  }
  EXPECT_EQ(std::filesystem::file_size(file("2026-01-01.jsonl.backup")), 100'000U);
}

TEST_F(JournalStore, AClockThatIsPutBackGoesOnInTheNewestFile) {
  Store store = open();
  ASSERT_FALSE(store.append(entry_at(5)));
  ASSERT_FALSE(store.append(entry_at(2)));
  EXPECT_THAT(names_in(directory_.journal()), ElementsAre("2026-01-05.jsonl"));
  EXPECT_TRUE(report().sound());
}

TEST_F(JournalStore, ANewestFileThatSomebodyRemovesIsMissed) {
  Store store = open();
  ASSERT_FALSE(store.append(entry_at(1)));
  ASSERT_FALSE(store.append(entry_at(2)));
  std::filesystem::remove(file("2026-01-02.jsonl"));
  ASSERT_FALSE(store.append(entry_at(2)));
  EXPECT_EQ(report().broken, "2026-01-02.jsonl:1: line 2 is missing before it");
}

TEST_F(JournalStore, SyncsWhatWasWrittenSince) {
  Store store = open();
  EXPECT_FALSE(store.sync());
  EXPECT_EQ(disk_.syncs(), 0U);
  ASSERT_FALSE(store.append(entry_at(1)));
  ASSERT_FALSE(store.append(entry_at(2)));
  EXPECT_FALSE(store.sync());
  EXPECT_EQ(disk_.syncs(), 2U) << "of both days";
  EXPECT_FALSE(store.sync());
  EXPECT_EQ(disk_.syncs(), 2U);
  ASSERT_FALSE(store.append(entry_at(2)));
  disk_.refuse_sync(EIO);
  EXPECT_THAT(store.sync(), Optional(HasSubstr("Input/output error")));
}

}  // namespace
}  // namespace journal
