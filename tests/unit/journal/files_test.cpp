#include "bridges/journal/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/journal/disk.h"

namespace journal {
namespace {

using testing::ElementsAre;

TEST(JournalFiles, NamesAreReadAsTheyAreMade) {
  const std::chrono::sys_days day = std::chrono::year(2026) / std::chrono::November / 26;
  EXPECT_EQ(to_string(FileName{day, 1}), "2026-11-26.jsonl");
  EXPECT_EQ(to_string(FileName{day, 12}), "2026-11-26.12.jsonl");
  EXPECT_EQ(parse_file_name("2026-11-26.jsonl"), (FileName{day, 1}));
  EXPECT_EQ(parse_file_name("2026-11-26.12.jsonl"), (FileName{day, 12}));
}

TEST(JournalFiles, WhatIsNamedOtherwiseIsNoFileOfAJournal) {
  for (const char* const name :
       {"", ".jsonl", "2026-11-26", "2026-11-26.json", "2026-11-26.jsonl.gz", "2026-11-26.1.jsonl",
        "2026-11-26.02.jsonl", "2026-11-26.0.jsonl", "2026-11-26..jsonl", "2026-11-26.-1.jsonl", "2026-02-30.jsonl",
        "2026-1-26.jsonl", "2026/11/26.jsonl", "x2026-11-26.jsonl", "2026-11-26.jsonl ", "2026-11-26.99999999999.jsonl",
        "2026-11-2.jsonl"}) {
    EXPECT_FALSE(parse_file_name(name)) << name;
  }
}

TEST(JournalFiles, StandInTheOrderOfTheChain) {
  const TemporaryDirectory directory;
  for (const char* const name : {"2026-11-26.jsonl", "2026-11-25.10.jsonl", "2026-11-25.2.jsonl", "2026-11-25.jsonl",
                                 "notes.txt", "2026-11-24.jsonl.old"}) {
    set_text(directory.path() / name, "x");
  }
  std::filesystem::create_directory(directory.path() / "2026-11-23.jsonl");
  EXPECT_THAT(names_in(directory.path()),
              ElementsAre("2026-11-25.jsonl", "2026-11-25.2.jsonl", "2026-11-25.10.jsonl", "2026-11-26.jsonl"));
}

TEST(JournalFiles, ADirectoryThatIsNotThereIsAFailure) {
  const TemporaryDirectory directory;
  std::error_code failure;
  EXPECT_TRUE(list_files(directory.path() / "none", failure).empty());
  EXPECT_EQ(failure, std::errc::no_such_file_or_directory);
}

}  // namespace
}  // namespace journal
