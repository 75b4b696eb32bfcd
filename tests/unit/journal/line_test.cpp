#include "bridges/journal/line.h"

#include <gtest/gtest.h>

#include "bridges/journal/json_text.h"
#include "bridges/journal/sha256.h"
#include "tests/unit/journal/disk.h"

namespace journal {
namespace {

const std::string kHash(64, 'a');

TEST(JournalLine, HashIsThatOfTheStandard) {
  // FIPS 180-4 examples.
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  Sha256 hash;
  hash.add("a");
  hash.add("bc");
  EXPECT_EQ(hash.finish(), sha256("abc"));
  EXPECT_EQ(hash.finish(), sha256("")) << "and begins anew";
}

TEST(JournalLine, IsReadAsItIsMade) {
  const std::string text = make_line(entry_at(2, 3, R"("phase":"lost","count":4)"), 17, kHash);
  EXPECT_EQ(text, R"({"n":17,"ts":"2026-01-02T03:00:00.000Z","mono":5.000000,"phase":"lost","count":4,"prev":")" +
                      kHash + "\"}");
  const auto line = parse_line(text);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->n, 17U);
  EXPECT_EQ(line->ts, "2026-01-02T03:00:00.000Z");
  EXPECT_EQ(line->phase, "lost");
  EXPECT_EQ(line->count, 4U);
  EXPECT_EQ(line->prev, kHash);
}

TEST(JournalLine, AnythingElseIsNone) {
  const std::string good = make_line(entry_at(2), 17, kHash);
  ASSERT_TRUE(parse_line(good));
  EXPECT_FALSE(parse_line(""));
  EXPECT_FALSE(parse_line("{"));
  EXPECT_FALSE(parse_line("[17]"));
  EXPECT_FALSE(parse_line(" " + good));
  EXPECT_FALSE(parse_line(good.substr(0, good.size() - 1)));
  EXPECT_FALSE(parse_line(good + "x"));
  EXPECT_FALSE(parse_line(std::string(3, '\0')));
  EXPECT_FALSE(parse_line("{\"n\":1,\"phase\":\"\xff\",\"prev\":\"" + kHash + "\"}"));
  EXPECT_FALSE(parse_line(make_line(entry_at(2), 0, kHash)));
  EXPECT_FALSE(parse_line(make_line(entry_at(2), 1, kHash.substr(1))));
  EXPECT_FALSE(parse_line(make_line(entry_at(2), 1, std::string(64, 'A'))));
  EXPECT_FALSE(parse_line(make_line(entry_at(2, 1, "\"id\":\"a\""), 1, kHash))) << "without a phase";
  EXPECT_FALSE(parse_line("{\"n\":-1,\"phase\":\"done\",\"prev\":\"" + kHash + "\"}"));
  EXPECT_FALSE(parse_line("{\"n\":1.5,\"phase\":\"done\",\"prev\":\"" + kHash + "\"}"));
  EXPECT_FALSE(
      parse_line(make_line(entry_at(2, 1, R"("phase":"done","id":")" + std::string(kMaxLine, 'x') + '"'), 1, kHash)));
  std::string deep = R"("phase":"done","x":)" + std::string(5000, '[');
  EXPECT_FALSE(parse_line(make_line(entry_at(2, 1, deep), 1, kHash)));
}

std::string text_in_json(std::string_view text) {
  std::string out;
  append_text(out, text);
  return out;
}

TEST(JournalLine, TextIsAlwaysJson) {
  EXPECT_EQ(text_in_json("pump1"), R"("pump1")");
  EXPECT_EQ(text_in_json("a\"b\\c\n"), R"("a\"b\\c\n")");
  EXPECT_EQ(text_in_json("Ventil geöffnet"), "\"Ventil geöffnet\"");
  EXPECT_EQ(text_in_json("a\xC3"), "\"a\xEF\xBF\xBD\"") << "cut in the middle of a character";
  EXPECT_EQ(text_in_json(std::string_view("a\0b", 3)), R"("a\u0000b")");
  EXPECT_EQ(text_in_json(std::string(5000, 'x')).size(), 1002U);
}

std::string value(canopen::DataType type, canopen::Raw raw, double scale = 1.0, unsigned decimals = 0) {
  config::Signal signal;
  signal.type = type;
  signal.scale = scale;
  signal.decimals = decimals;
  std::string out;
  append_value(out, signal, raw);
  return out;
}

TEST(JournalLine, ValuesAreInEngineeringUnits) {
  using canopen::DataType;
  EXPECT_EQ(value(DataType::u16, 4997, 0.01, 2), "49.97");
  EXPECT_EQ(value(DataType::i16, static_cast<canopen::Raw>(-5), 0.1, 1), "-0.5");
  EXPECT_EQ(value(DataType::u64, ~canopen::Raw{0}), "18446744073709551615");
  EXPECT_EQ(value(DataType::i32, static_cast<canopen::Raw>(-7)), "-7");
  EXPECT_EQ(value(DataType::boolean, 1), "true");
  EXPECT_EQ(value(DataType::f32, 0x3F000000), "0.5");
  EXPECT_EQ(value(DataType::f32, 0x7FC00000), "null");
}

}  // namespace
}  // namespace journal
