#include "bridges/journal/verify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/journal/disk.h"

namespace journal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// Three days of four lines each: lines 1 to 4, 5 to 8, 9 to 12.
class JournalVerify : public testing::Test {
 protected:
  JournalVerify() {
    Store store(directory_.journal(), 1'000'000, FileCalls::real());
    for (int day = 1; day <= 3; ++day) {
      for (int hour = 0; hour < 4; ++hour) {
        EXPECT_FALSE(store.append(entry_at(day, hour)));
      }
    }
  }

  [[nodiscard]] std::filesystem::path file(int day) const {
    return directory_.journal() / ("2026-01-0" + std::to_string(day) + ".jsonl");
  }
  // Replaces line `number` (from 1), with its line break, of a day.
  void replace_line(int day, std::size_t number, const std::string& text) const {
    std::vector<std::string> lines = lines_of(file(day));
    std::string all;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      all += i + 1 == number ? text : lines[i] + '\n';
    }
    set_text(file(day), all);
  }
  [[nodiscard]] std::string line(int day, std::size_t number) const { return lines_of(file(day)).at(number - 1); }
  [[nodiscard]] Report report() const {
    std::error_code failure;
    Report found = verify(directory_.journal(), failure);
    EXPECT_FALSE(failure);
    return found;
  }

  TemporaryDirectory directory_;
};

TEST_F(JournalVerify, ASoundJournal) {
  const Report found = report();
  EXPECT_EQ(found.broken, "");
  EXPECT_THAT(found.remarks, IsEmpty());
  EXPECT_EQ(found.lines, 12U);
  EXPECT_EQ(found.files, 3U);
  EXPECT_EQ(found.from, "2026-01-01T00:00:00.000Z");
  EXPECT_EQ(found.to, "2026-01-03T03:00:00.000Z");
  EXPECT_EQ(found.newest, 12U);
  EXPECT_EQ(found.newest_hash, sha256(line(3, 4)));
}

TEST_F(JournalVerify, ALineThatIsOlderThanTheOneBeforeItIsNotTheLatest) {
  Store store(directory_.journal(), 1'000'000, FileCalls::real());
  EXPECT_FALSE(store.append(entry_at(3, 9)));
  EXPECT_FALSE(store.append(entry_at(3, 8)));  // as one is that counts commands of a minute, written at its end
  const Report found = report();
  EXPECT_EQ(found.broken, "");
  EXPECT_EQ(found.newest, 14U);
  EXPECT_EQ(found.to, "2026-01-03T09:00:00.000Z");
}

TEST_F(JournalVerify, AChangedByteAnywhereIsFoundAndItsLineNamed) {
  // Of the last line, which nothing follows, only what makes it no line is found.
  for (int day = 1; day <= 3; ++day) {
    const std::string before = text_of(file(day));
    std::size_t number = 1;
    for (std::size_t i = 0; i < before.size() && (day < 3 || number < 4); ++i) {
      if (i % 5 != 0 && before[i] != '\n') {
        continue;
      }
      std::string changed = before;
      changed[i] = static_cast<char>(changed[i] ^ 1);
      set_text(file(day), changed);
      EXPECT_THAT(report().broken,
                  StartsWith("2026-01-0" + std::to_string(day) + ".jsonl:" + std::to_string(number) + ":"))
          << "byte " << i;
      number += before[i] == '\n' ? 1U : 0U;
    }
    set_text(file(day), before);
  }
  EXPECT_TRUE(report().sound());
}

TEST_F(JournalVerify, AMissingLineIsNamedWhereverItStood) {
  replace_line(1, 2, "");
  EXPECT_EQ(report().broken, "2026-01-01.jsonl:2: line 2 is missing before it");
}

TEST_F(JournalVerify, MissingLinesAtTheEndOfAFile) {
  replace_line(1, 4, "");
  replace_line(1, 3, "");
  EXPECT_EQ(report().broken, "2026-01-02.jsonl:1: lines 3 to 4 are missing before it");
}

TEST_F(JournalVerify, AMissingFileBetweenOthers) {
  std::filesystem::remove(file(2));
  EXPECT_EQ(report().broken, "2026-01-03.jsonl:1: lines 5 to 8 are missing before it");
}

TEST_F(JournalVerify, RemovedOldestFilesAreInOrder) {
  std::filesystem::remove(file(1));
  const Report found = report();
  EXPECT_TRUE(found.sound()) << found.broken;
  EXPECT_THAT(found.remarks,
              ElementsAre("2026-01-02.jsonl:1: the first that is kept is line 5, older files were removed"));
}

TEST_F(JournalVerify, LinesThatChangePlacesOrStandTwice) {
  const std::string second = line(2, 2);
  replace_line(2, 3, line(2, 3) + '\n' + second + '\n');
  EXPECT_EQ(report().broken, "2026-01-02.jsonl:4: changed: it says that it is line 6, after line 7");
}

TEST_F(JournalVerify, AnAddedLineOfAnyKind) {
  replace_line(2, 2, line(2, 2) + "\nnonsense\n");
  EXPECT_THAT(report().broken, StartsWith("2026-01-02.jsonl:3: changed"));
}

TEST_F(JournalVerify, AnAddedLineAtTheEnd) {
  set_text(file(3), text_of(file(3)) + "nonsense\n");
  EXPECT_THAT(report().broken, StartsWith("2026-01-03.jsonl:5: changed"));
}

TEST_F(JournalVerify, ATornLastLineIsARemark) {
  set_text(file(3), text_of(file(3)) + R"({"n":13,"ts":"2026)");
  const Report found = report();
  EXPECT_TRUE(found.sound()) << found.broken;
  EXPECT_THAT(found.remarks, ElementsAre(HasSubstr("2026-01-03.jsonl:5: torn")));
  EXPECT_EQ(found.lines, 12U);
}

TEST_F(JournalVerify, ALastLineThatLacksOnlyItsLineBreakCounts) {
  const std::string text = text_of(file(3));
  set_text(file(3), text.substr(0, text.size() - 1));
  const Report found = report();
  EXPECT_TRUE(found.sound()) << found.broken;
  EXPECT_THAT(found.remarks, ElementsAre("2026-01-03.jsonl:4: torn: only its line break is missing"));
  EXPECT_EQ(found.newest, 12U);
  const std::string earlier = text_of(file(1));
  set_text(file(1), earlier.substr(0, earlier.size() - 1));
  EXPECT_THAT(report().broken, StartsWith("2026-01-01.jsonl:4: changed"));
}

TEST_F(JournalVerify, ALineThatDoesNotEndBeforeOthersIsChanged) {
  set_text(file(2), text_of(file(2)) + R"({"n":13,"ts":"2026)");
  EXPECT_THAT(report().broken, StartsWith("2026-01-02.jsonl:5: changed"));
}

TEST_F(JournalVerify, AfterARestartATornLineIsARemarkAndItsBytesCount) {
  const std::string torn = std::string("{\"n\":13,\0\0\xff", 11);
  set_text(file(3), text_of(file(3)) + torn);
  {
    Store store(directory_.journal(), 1'000'000, FileCalls::real());
    ASSERT_FALSE(store.append(entry_at(3, 5)));
  }
  const Report found = report();
  EXPECT_TRUE(found.sound()) << found.broken;
  EXPECT_THAT(found.remarks, ElementsAre(HasSubstr("2026-01-03.jsonl:5: torn")));
  EXPECT_EQ(found.newest, 14U) << "one about the torn one, one that was appended";
  const std::string before = text_of(file(3));
  std::string changed = before;
  changed[before.find(torn)] = '[';
  set_text(file(3), changed);
  EXPECT_EQ(report().broken, "2026-01-03.jsonl:5: changed: the torn line is another than it was");
  set_text(file(3), before.substr(0, before.find(torn)) + before.substr(before.find(torn) + torn.size() + 1));
  EXPECT_EQ(report().broken, "2026-01-03.jsonl:5: the torn line before it is missing");
}

TEST_F(JournalVerify, LostLinesAreCounted) {
  Store store(directory_.journal(), 1'000'000, FileCalls::real());
  ASSERT_FALSE(store.append(entry_at(3, 5, R"("phase":"lost","count":7)")));
  EXPECT_EQ(report().lost, 7U);
}

TEST_F(JournalVerify, AFirstLineThatNamesOneBeforeIt) {
  replace_line(1, 1, make_line(entry_at(1, 0), 1, std::string(64, 'b')) + '\n');
  EXPECT_EQ(report().broken, "2026-01-01.jsonl:1: changed: it is the first line and names one before it");
}

TEST_F(JournalVerify, ALastLineThatIsWrongAndDoesNotEnd) {
  for (const int day : {1, 2}) {
    std::filesystem::remove(file(day));
  }
  set_text(file(3), make_line(entry_at(1, 0), 1, std::string(64, 'b')));
  EXPECT_THAT(report().broken, StartsWith("2026-01-03.jsonl:1: changed"));
}

TEST(JournalVerifyOf, AnEmptyDirectoryIsSound) {
  const TemporaryDirectory directory;
  std::error_code failure;
  const Report found = verify(directory.path(), failure);
  EXPECT_FALSE(failure);
  EXPECT_TRUE(found.sound());
  EXPECT_EQ(found.lines, 0U);
}

}  // namespace
}  // namespace journal
