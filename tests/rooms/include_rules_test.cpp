#include "tests/rooms/include_rules.h"

#include <gtest/gtest.h>

namespace rooms {
namespace {

bool passes(std::string_view file, std::string_view included) {
  return check_text(file, "#include \"" + std::string(included) + "\"\n").empty();
}

TEST(IncludeRules, NameFileLineAndReason) {
  const std::vector<Violation> found = check_text(
      "canopen/bus/bus.cpp", "#include \"canopen/bus/bus.h\"\n\n#include <vector>\n#include \"config/model.h\"\n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(to_string(found.front()),
            "canopen/bus/bus.cpp:4: \"config/model.h\": canopen/ may not include this of config/");
}

TEST(IncludeRules, CanopenKnowsNobody) {
  EXPECT_TRUE(passes("canopen/sdo/client.cpp", "canopen/bus/bus.h"));
  for (const char* other : {"config/model.h", "bridges/process/image.h", "simulator/drive.h", "daemon/gateway.h"}) {
    EXPECT_FALSE(passes("canopen/sdo/client.cpp", other)) << other;
  }
}

TEST(IncludeRules, ConfigKnowsPlainValues) {
  EXPECT_TRUE(passes("config/model.h", "canopen/object.h"));
  EXPECT_TRUE(passes("config/model.h", "canopen/bus/wire_bits.h"));
  EXPECT_FALSE(passes("config/model.h", "canopen/frame.h"));
  EXPECT_FALSE(passes("config/model.h", "canopen/bus/link.h"));
  EXPECT_FALSE(passes("config/model.h", "canopen/node/remote_node.h"));
}

TEST(IncludeRules, ProcessKnowsTheRemoteDriveButNoFrames) {
  EXPECT_TRUE(passes("bridges/process/commands.cpp", "canopen/node/remote_node.h"));
  EXPECT_TRUE(passes("bridges/process/commands.cpp", "config/model.h"));
  EXPECT_FALSE(passes("bridges/process/commands.cpp", "canopen/frame.h"));
  EXPECT_FALSE(passes("bridges/process/commands.cpp", "canopen/bus/link.h"));
  EXPECT_FALSE(passes("bridges/process/commands.cpp", "config/load.h"));
}

TEST(IncludeRules, BridgesDoNotKnowEachOther) {
  for (const char* file : {"bridges/modbus/server.cpp", "bridges/mqtt/bridge.cpp"}) {
    EXPECT_TRUE(passes(file, "bridges/process/image.h"));
    EXPECT_FALSE(passes(file, "canopen/node/remote_node.h"));
    EXPECT_FALSE(passes(file, "config/load.h"));
  }
  EXPECT_FALSE(passes("bridges/modbus/server.cpp", "bridges/mqtt/bridge.h"));
  EXPECT_FALSE(passes("bridges/mqtt/bridge.cpp", "bridges/modbus/server.h"));
  EXPECT_FALSE(passes("bridges/mqtt/bridge.cpp", "bridges/journal/journal.h"));
  EXPECT_FALSE(passes("bridges/journal/journal.cpp", "bridges/mqtt/topics.h"));
  EXPECT_FALSE(passes("bridges/process/image.cpp", "bridges/modbus/server.h"));
}

TEST(IncludeRules, SimulatorKnowsNoServiceOfTheMaster) {
  EXPECT_TRUE(passes("simulator/drive.h", "canopen/bus/link.h"));
  for (const char* other : {"canopen/node/pdo.h", "canopen/object.h", "canopen/sdo/client.h", "config/model.h"}) {
    EXPECT_FALSE(passes("simulator/drive.h", other)) << other;
  }
}

TEST(IncludeRules, DaemonKnowsEverybodyButTests) {
  EXPECT_TRUE(passes("daemon/main.cpp", "config/load.h"));
  EXPECT_TRUE(passes("daemon/main.cpp", "bridges/mqtt/bridge.h"));
  EXPECT_FALSE(passes("daemon/main.cpp", "tests/support/hand_driven_loop.h"));
}

TEST(IncludeRules, SeeThroughOtherSpellings) {
  EXPECT_EQ(check_text("canopen/bus/bus.h", "  #  include <config/model.h>\n").size(), 1U);
  EXPECT_EQ(check_text("canopen/bus/bus.h", "#include \"link.h\"\n").size(), 1U) << "not named from the root";
  EXPECT_EQ(check_text("canopen/bus/bus.h", "#include \"../config/model.h\"\n").size(), 1U);
  EXPECT_TRUE(check_text("canopen/bus/bus.h", "// #include \"config/model.h\"\n").empty());
  EXPECT_TRUE(check_text("tests/unit/canopen/bus_test.cpp", "#include \"config/load.h\"\n").empty());
}

}  // namespace
}  // namespace rooms
