#include "bridges/alarms/alarm_memory.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/unit/alarms/memory_bench.h"

namespace alarms {
namespace {

void expect_kept(const AlarmMemory& memory) {
  const ReadMemory back = parse_memory(memory_text(memory));
  EXPECT_EQ(back.wrong, "");
  EXPECT_EQ(back.memory, memory);
}

TEST(AlarmMemory, IsReadBackAsItWasWritten) {
  expect_kept(memory_with(3));
  expect_kept({});
  AlarmMemory memory = memory_with(3);
  memory.newest_first = NamedFault{"", "can0", AlarmKind::emcy};
  expect_kept(memory);
  memory.newest_first = NamedFault{"pump1", "", AlarmKind::control};
  expect_kept(memory);
}

TEST(AlarmMemory, IsOneDocumentWithALineForEach) {
  AlarmMemory memory = memory_with(3);
  memory.drives.resize(1);
  memory.drives[0].alarms = {};
  memory.buses.clear();
  EXPECT_EQ(memory_text(memory),
            "{\"version\":1,\"gateway\":\"line3\",\"drives\":{\"pump1\":\n{}},\"buses\":{},"
            "\"first\":{\"drive\":\"pump1\",\"kind\":\"emcy\"}}\n");
}

TEST(AlarmMemory, AnyPartOfItIsNone) {
  const std::string text = memory_text(memory_with(3));
  for (std::size_t size = 0; size + 1 < text.size(); ++size) {
    const ReadMemory read = parse_memory(text.substr(0, size));
    EXPECT_FALSE(read.wrong.empty()) << size;
    EXPECT_EQ(read.memory, AlarmMemory{});
  }
}

TEST(AlarmMemory, TellsWhatIsWrong) {
  const std::string good = memory_text(memory_with(3));
  const std::vector<std::array<std::string, 3>> cases{
      {"\"version\":1", "\"version\":2", R"("version" is not 1)"},
      {"\"version\":1,", "", R"("version" is not 1)"},
      {"\"gateway\":\"line3\"", "\"gateway\":3", R"("gateway" is not a text)"},
      {"\"drives\":{", "\"x\":{", R"("drives" is not an object)"},
      {"\"fan 2\":\n{}", "\"fan 2\":\n1", "drive fan 2 is not an object"},
      {"\"code\":\"0x2310\"", "\"code\":2310", R"(drive pump1, emcy: "code" is not 0x and four hexadecimal digits)"},
      {"\"can0\":\n{", "\"can0\":\n[{", "it is no JSON: "},
      {"\"can0\":\n{\"active\":false", "\"can0\":\n{\"active\":0", R"(bus can0: "active" is not true or false)"},
      {"\"kind\":\"emcy\"", "\"kind\":\"fuse\"", R"("kind" is not a kind of alarm)"},
      {"\"first\":{\"drive\":\"pump1\"", "\"first\":{\"drive\":1", R"("drive" is not a text)"},
      {"\"first\":{\"drive\":\"pump1\",\"kind\":\"emcy\"}", "\"first\":7", R"("first" is not an object)"}};
  for (const auto& [from, to, wrong] : cases) {
    std::string text = good;
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
    const ReadMemory read = parse_memory(text);
    EXPECT_EQ(read.wrong.substr(0, wrong.size()), wrong) << text;
    EXPECT_EQ(read.memory, AlarmMemory{});
  }
  EXPECT_EQ(parse_memory("[]").wrong, "it is no object");
}

}  // namespace
}  // namespace alarms
