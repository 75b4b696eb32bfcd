#include "daemon/http/target.h"

#include <gtest/gtest.h>

namespace gateway::http {
namespace {

std::string mistake_of(std::string_view text) {
  const auto parsed = parse_target(text);
  const auto* const mistake = std::get_if<TargetMistake>(&parsed);
  return mistake == nullptr ? "" : mistake->text;
}

Target target_of(std::string_view text) {
  EXPECT_EQ(mistake_of(text), "") << text;
  auto parsed = parse_target(text);
  return std::holds_alternative<Target>(parsed) ? std::get<Target>(std::move(parsed)) : Target{};
}

TEST(HttpTarget, IsPathAndParameters) {
  const Target target = target_of("/api/history?drive=pump1&count=5&flag&empty=&&last=a=b");
  EXPECT_EQ(target.path, "/api/history");
  EXPECT_EQ(target.host, "");
  ASSERT_EQ(target.parameters.size(), 5U);
  EXPECT_EQ(*target.find("drive"), "pump1");
  EXPECT_EQ(*target.find("count"), "5");
  EXPECT_EQ(*target.find("flag"), "");
  EXPECT_EQ(*target.find("empty"), "");
  EXPECT_EQ(*target.find("last"), "a=b");
  EXPECT_EQ(target.find("none"), nullptr);
  EXPECT_TRUE(target_of("/?").parameters.empty());
}

TEST(HttpTarget, IsDecoded) {
  const Target target = target_of("/api/drives/p%75mp%2d1+2?n%61me=a%20b+c%2b%C3%A4");
  EXPECT_EQ(target.path, "/api/drives/pump-1+2") << "a plus is a blank in parameters only";
  EXPECT_EQ(*target.find("name"), "a b c+\xC3\xA4");
}

TEST(HttpTarget, MayNameItsHost) {
  EXPECT_EQ(target_of("http://line3:9464/metrics?a=%31").host, "line3:9464");
  EXPECT_EQ(target_of("http://line3:9464/metrics").path, "/metrics");
  EXPECT_EQ(target_of("http://line3").path, "/");
  EXPECT_EQ(target_of("http://line3?a=1").path, "/");
}

TEST(HttpTarget, MistakesHavePlaceAndRemedy) {
  constexpr std::string_view kRemedy = ": behind % stand two hexadecimal digits; write %25 for the sign % itself";
  for (const auto& [text, byte] : {std::pair("/a%", 3),
                                   {"/a%4", 3},
                                   {"/%zz", 2},
                                   {"/?a=1&b=5%", 10},
                                   {"/?%g1=1", 3},
                                   {"/x?a=%41%4", 9},
                                   {"http://h/%", 10}}) {
    EXPECT_EQ(mistake_of(text), "byte " + std::to_string(byte) + " of the target" + std::string(kRemedy)) << text;
  }
  EXPECT_EQ(mistake_of("/a%00"), "byte 3 of the target: %00 stands in no name and no number; leave it out");
  EXPECT_EQ(mistake_of("*"), "byte 1 of the target: it begins with a slash");
  EXPECT_EQ(mistake_of(""), "byte 1 of the target: it begins with a slash");
  EXPECT_EQ(mistake_of("http:///x"), "byte 8 of the target: a host is missing behind http://");
}

}  // namespace
}  // namespace gateway::http
