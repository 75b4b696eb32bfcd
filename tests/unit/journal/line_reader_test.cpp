#include "bridges/journal/line_reader.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/journal/disk.h"

namespace journal {
namespace {

const std::string kNone(kNoHash);

struct Read {
  std::vector<ReadLine> lines;
  Junk rest;
  bool unended = false;
};

Read read(const std::string& text, std::size_t piece) {
  Read result;
  LineReader reader([&](const ReadLine& line) { result.lines.push_back(line); });
  for (std::size_t at = 0; at < text.size(); at += piece) {
    reader.add(std::string_view(text).substr(at, piece));
  }
  result.unended = reader.unended();
  result.rest = reader.finish();
  return result;
}

TEST(JournalLineReader, CutsTheSameLinesFromPiecesOfAnySize) {
  const std::string first = make_line(entry_at(1), 1, kNone);
  const std::string second = make_line(entry_at(1), 2, kNone);
  const std::string text = first + "\nno line\n\n" + second + "\n{\"n\":3";
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, text.size()}) {
    const Read result = read(text, piece);
    ASSERT_EQ(result.lines.size(), 2U);
    EXPECT_EQ(result.lines[0].hash, sha256(first));
    EXPECT_EQ(result.lines[0].end, first.size() + 1);
    EXPECT_EQ(result.lines[0].before.bytes, 0U);
    EXPECT_EQ(result.lines[1].number, 4U);
    EXPECT_EQ(result.lines[1].line.n, 2U);
    EXPECT_EQ(result.lines[1].before.line, 2U);
    EXPECT_EQ(result.lines[1].before.line_breaks, 2U);
    EXPECT_EQ(result.lines[1].before.sha256, sha256("no line\n\n"));
    EXPECT_TRUE(result.unended);
    EXPECT_EQ(result.rest.bytes, 6U);
    EXPECT_EQ(result.rest.line, 5U);
    EXPECT_EQ(result.rest.line_breaks, 0U);
    EXPECT_EQ(result.rest.sha256, sha256("{\"n\":3"));
  }
}

TEST(JournalLineReader, ALineWithoutEndTakesNoMemoryAndIsHashedAllTheSame) {
  const std::string huge(kMaxLine + 100'000, 'x');
  const std::string good = make_line(entry_at(1), 1, kNone);
  for (const std::size_t piece : {std::size_t{4096}, huge.size() * 2}) {
    const Read result = read(huge + '\n' + good + '\n' + huge, piece);
    ASSERT_EQ(result.lines.size(), 1U);
    EXPECT_EQ(result.lines[0].before.sha256, sha256(huge + '\n'));
    EXPECT_EQ(result.lines[0].before.bytes, huge.size() + 1);
    EXPECT_EQ(result.lines[0].end, huge.size() + good.size() + 2);
    EXPECT_TRUE(result.unended);
    EXPECT_EQ(result.rest.sha256, sha256(huge));
  }
}

}  // namespace
}  // namespace journal
