#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "config/drive/drive_keys.h"
#include "config/schema/section.h"
#include "config/site/site_keys.h"
#include "config/text.h"

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
  const std::string reference = render_reference({&site_section(), &profile_section()});
  const std::string rendered = testing::TempDir() + "configuration-reference.md";
  std::ofstream(rendered) << reference;
  EXPECT_NE(read(GATEWAY_SOURCE_DIR "/docs/CONFIGURATION.md").find(reference), std::string::npos)
      << "replace the tables under \"All keys\" by " << rendered;
}

void check_section(const Section& section, int depth) {
  ASSERT_LT(depth, 10);
  for (const Section* at = &section; at != nullptr; at = at->also()) {
    for (const Key& key : at->keys()) {
      const std::string name = key.name.ends_with('N') ? key.name.substr(0, key.name.size() - 1) + "7" : key.name;
      EXPECT_EQ(section.find(name), &key) << name << " stands twice";
      EXPECT_FALSE(key.meaning.empty()) << key.name;
      EXPECT_FALSE(key.type.empty()) << key.name;
      EXPECT_EQ(static_cast<bool>(key.check), key.built) << key.name;
      if (key.below != nullptr) {
        check_section(*key.below, depth + 1);
      }
    }
  }
}

TEST(TheSchema, IsWellFormed) {
  check_section(site_section(), 0);
  check_section(profile_section(), 0);
}

// Its default is worded, because the usual spelling of a minute is another.
TEST(TheSchema, WordsTheLongestIntervalAsItIs) {
  EXPECT_EQ(parse_duration(mqtt_section().find("max_interval")->standard), Mqtt().max_interval);
}

TEST(NumberedKeys, ReachFromOneToFiveHundredAndTwelve) {
  EXPECT_NE(overlay_section().find("tpdo1"), nullptr);
  EXPECT_NE(overlay_section().find("rpdo512"), nullptr);
  for (const auto* const name : {"tpdo", "tpdo0", "tpdo01", "tpdo513", "tpdo-1", "tpdo1x", "tpdo0x1", "tpdoN"}) {
    EXPECT_EQ(overlay_section().find(name), nullptr) << name;
  }
}

}  // namespace
}  // namespace config
