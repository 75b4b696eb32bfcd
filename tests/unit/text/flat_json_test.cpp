#include "bridges/text/flat_json.h"

#include <gtest/gtest.h>

#include <string>

namespace text {
namespace {

using Kind = Scalar::Kind;

std::string refusal(std::string_view text) {
  const auto parsed = parse_flat(text);
  return parsed.has_error() ? parsed.error().detail : "accepted";
}

TEST(FlatJson, KeepsDigitsAndOrder) {
  const auto parsed =
      parse_flat(R"( {"b": 18446744073709551616, "a":-0.10e1 , "s":"x\u00fcy", "t":true,"f":false,"n":null} )");
  ASSERT_TRUE(parsed.has_value()) << parsed.error().detail;
  const FlatObject expected{{"b", {Kind::number, "18446744073709551616"}},
                            {"a", {Kind::number, "-0.10e1"}},
                            {"s", {Kind::string, "x\xC3\xBCy"}},
                            {"t", {Kind::boolean, "true"}},
                            {"f", {Kind::boolean, "false"}},
                            {"n", {Kind::null, "null"}}};
  EXPECT_EQ(parsed.value(), expected);
}

TEST(FlatJson, AnEmptyObjectIsOne) {
  ASSERT_TRUE(parse_flat("{}").has_value());
  EXPECT_TRUE(parse_flat("{}").value().empty());
}

TEST(FlatJson, SaysWhereTextIsNoJson) {
  EXPECT_EQ(parse_flat("{\"a\":1").error().kind, canopen::ErrorKind::type);
  EXPECT_NE(refusal("{\"a\":!}").find("not valid JSON at character 6"), std::string::npos) << refusal("{\"a\":!}");
  EXPECT_NE(refusal("{\"a\":1").find("not valid JSON"), std::string::npos);
  EXPECT_NE(refusal("{\"a\":1}x").find("more behind the object"), std::string::npos) << refusal("{\"a\":1}x");
  EXPECT_NE(refusal("").find("not valid JSON"), std::string::npos);
  EXPECT_NE(refusal("{\"a\":NaN}").find("not valid JSON"), std::string::npos);
  EXPECT_NE(refusal("{'a':1}").find("not valid JSON"), std::string::npos);
  EXPECT_NE(refusal("{\"a\":\"\xFF\"}").find("not valid JSON"), std::string::npos);
}

TEST(FlatJson, RefusesWhatIsNotFlat) {
  EXPECT_NE(refusal(R"({"a":{"b":1}})").find("an object inside the object"), std::string::npos);
  EXPECT_NE(refusal(R"({"a":[1]})").find("a list"), std::string::npos);
  EXPECT_NE(refusal("[1]").find("a list"), std::string::npos);
  EXPECT_NE(refusal("1").find("a single value"), std::string::npos) << refusal("1");
  EXPECT_NE(refusal("\"a\"").find("a single value"), std::string::npos);
  EXPECT_NE(refusal("null").find("a single value"), std::string::npos);
}

TEST(FlatJson, RefusesANameGivenTwice) {
  EXPECT_NE(refusal(R"({"run":0,"run":1})").find("\"run\" twice"), std::string::npos);
  EXPECT_NE(refusal(R"({"run":0,"r\u0075n":1})").find("\"run\" twice"), std::string::npos);
}

}  // namespace
}  // namespace text
