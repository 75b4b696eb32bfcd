#include "config/toml/document.h"

#include <gtest/gtest.h>

#include <string>

namespace config {
namespace {

Node parse(std::string_view text) {
  auto result = parse_toml(text, 7);
  EXPECT_TRUE(std::holds_alternative<Node>(result));
  return std::holds_alternative<Node>(result) ? std::get<Node>(result) : Node{};
}

ParseFailure failure_of(std::string_view text) {
  auto result = parse_toml(text, 7);
  EXPECT_TRUE(std::holds_alternative<ParseFailure>(result));
  return std::holds_alternative<ParseFailure>(result) ? std::get<ParseFailure>(result) : ParseFailure{};
}

TEST(Document, KeepsTheOrderAndThePlaces) {
  const Node root = parse("zebra = 1\n\n[apple]\n  pear = \"x\"\n");
  ASSERT_EQ(root.entries.size(), 2U);
  EXPECT_EQ(root.entries[0].key, "zebra");
  EXPECT_EQ(root.entries[0].value.place.line, 1U);
  EXPECT_EQ(root.entries[0].value.place.column, 9U);
  EXPECT_EQ(root.entries[0].value.place.file, 7U);
  const Entry& pear = root.entries[1].value.entries.at(0);
  EXPECT_EQ(pear.key_place.line, 4U);
  EXPECT_EQ(pear.key_place.column, 3U);
  EXPECT_EQ(pear.value.place.column, 10U);
  EXPECT_EQ(pear.value.text, "x");
}

TEST(Document, TellsWhatIsNoToml) {
  EXPECT_EQ(failure_of("a = 1\nb = = 2\n").place.line, 2U);
  EXPECT_EQ(failure_of("a = 1\na = 2\n").place.line, 2U);
  EXPECT_EQ(failure_of("a = \"\xff\"\n").place.line, 1U);
}

/// `[a.a.a. … .b]` of so many bytes.
std::string deep_heading(std::size_t bytes) {
  std::string deep = "[";
  while (deep.size() + 4 <= bytes) {
    deep += "a.";
  }
  return deep + std::string(bytes - 1 - deep.size(), 'b') + "]";
}

// Keys nested without end would run toml++ out of stack; a key ends with its line.
TEST(Document, RefusesLongLines) {
  const ParseFailure failure = failure_of("x = 1\n" + deep_heading(200'000) + "\n");
  EXPECT_EQ(failure.place.line, 2U);
  EXPECT_EQ(failure.place.column, 4097U);
  EXPECT_EQ(failure.text.substr(0, 32), "a line of more than 4096 bytes; ");
  EXPECT_EQ(failure_of("x = 1\n# " + std::string(4095, '.')).place.line, 2U);
}

TEST(Document, ReadsTheLongestLineWhateverItHolds) {
  const Node root = parse("x = 1\n" + deep_heading(4096) + "\ny = 1\n");
  EXPECT_EQ(root.entries.size(), 2U);
  EXPECT_EQ(parse("# " + std::string(4094, '.') + "\n\nx = 1").entries.size(), 1U);
}

TEST(Document, ReadsDatesAsSomethingElse) {
  EXPECT_EQ(parse("a = 1979-05-27\n").entries.at(0).value.kind, NodeKind::other);
}

}  // namespace
}  // namespace config
