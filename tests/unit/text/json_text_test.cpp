#include "bridges/text/json_text.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace text {
namespace {

std::string quoted(std::string_view text) {
  std::string out;
  append_quoted(out, text);
  return out;
}

TEST(JsonText, KnowsUtf8) {
  for (const char* text : {"", "pump1", "a\"b\\c\n", "\x7F", "\xC3\xBC", "\xDF\xBF", "\xE0\xA0\x80", "\xE2\x82\xAC",
                           "\xED\x9F\xBF", "\xEE\x80\x80", "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_TRUE(is_utf8(text)) << text;
  }
  EXPECT_TRUE(is_utf8(std::string_view("\0", 1)));
  for (const char* text :
       {"\x80", "\xBF", "a\xC3", "\xC0\xAF", "\xC1\xBF", "\xE0\x9F\xBF", "\xE2\x82", "\xED\xA0\x80", "\xED\xBF\xBF",
        "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF", "\xFE", "\xC3\xC3\xBC", "\xF0\x90\x80"}) {
    EXPECT_FALSE(is_utf8(text)) << text;
  }
}

TEST(JsonText, QuotesWhateverItIs) {
  EXPECT_EQ(quoted("pump1"), R"("pump1")");
  EXPECT_EQ(quoted("a\"b\\c\n"), R"("a\"b\\c\n")");
  EXPECT_EQ(quoted("ge\xC3\xB6"
                   "ffnet"),
            "\"ge\xC3\xB6"
            "ffnet\"");
  EXPECT_EQ(quoted("a\xC3"), "\"a\xEF\xBF\xBD\"");
  EXPECT_EQ(quoted("\xC3\xB6\n\"\xFF"), "\"\xC3\xB6\\n\\\"\xEF\xBF\xBD\"") << "what is a character stays";
}

TEST(JsonText, WhatIsNotThereIsNull) {
  std::string out;
  ObjectText object(out);
  object.text("a", std::string("x"));
  object.text("b", std::nullopt);
  object.integer("c", 7U);
  object.integer("d", std::nullopt);
  object.number("e", 0.1);
  object.number("f", std::numeric_limits<double>::quiet_NaN());
  object.number("g", std::nullopt);
  object.close();
  EXPECT_EQ(out, R"({"a":"x","b":null,"c":7,"d":null,"e":0.1,"f":null,"g":null})");
}

TEST(JsonText, Lists) {
  std::string out;
  append_list(out, std::vector<std::string>{}, append_quoted);
  append_list(out, std::vector<std::string>{"a"}, append_quoted);
  append_list(out, std::vector<std::string>{"a", "b", "c"}, append_quoted);
  EXPECT_EQ(out, R"([]["a"]["a","b","c"])");
}

}  // namespace
}  // namespace text
