#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "config/schema.h"

namespace config {
namespace {

std::string read(const std::string& path) {
  std::ifstream in(path);
  std::stringstream content;
  content << in.rdbuf();
  return content.str();
}

// The reference is rendered from the tables that check a file, so the manual cannot lag behind them.
TEST(TheManual, HoldsTheReferenceOfAllKeys) {
  const std::string reference = render_reference();
  const std::string rendered = testing::TempDir() + "configuration-reference.md";
  std::ofstream(rendered) << reference;
  EXPECT_NE(read(GATEWAY_SOURCE_DIR "/docs/CONFIGURATION.md").find(reference), std::string::npos)
      << "replace the tables under \"All keys\" by " << rendered;
}

void check_section(const Section& section, int depth) {
  ASSERT_LT(depth, 10);
  for (const Section* at = &section; at != nullptr; at = at->also) {
    for (const Key& key : at->keys) {
      EXPECT_EQ(find_key(section, key.name), &key) << key.name << " stands twice";
      EXPECT_FALSE(key.meaning.empty()) << key.name;
      EXPECT_LE(key.min, key.max) << key.name;
      const bool has_section = key.kind == KeyKind::table || key.kind == KeyKind::tables ||
                               key.kind == KeyKind::signals || key.kind == KeyKind::presets;
      EXPECT_EQ(key.section != nullptr, has_section && key.support != Support::none) << key.name;
      EXPECT_EQ(key.choices.empty(), key.kind != KeyKind::choice && key.kind != KeyKind::choices) << key.name;
      if (key.section != nullptr) {
        check_section(*key.section, depth + 1);
      }
    }
  }
}

TEST(TheSchema, IsWellFormed) {
  check_section(kSiteSection, 0);
  check_section(kProfileSection, 0);
}

TEST(NumberedKeys, ReachFromOneToFiveHundredAndTwelve) {
  EXPECT_NE(find_key(kOverlaySection, "tpdo1"), nullptr);
  EXPECT_NE(find_key(kOverlaySection, "rpdo512"), nullptr);
  for (const auto* const name : {"tpdo", "tpdo0", "tpdo01", "tpdo513", "tpdo-1", "tpdo1x", "tpdo0x1"}) {
    EXPECT_EQ(find_key(kOverlaySection, name), nullptr) << name;
  }
}

}  // namespace
}  // namespace config
