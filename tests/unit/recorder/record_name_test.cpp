#include "bridges/recorder/record_name.h"

#include <gtest/gtest.h>

#include "tests/unit/recorder/record_bench.h"

namespace recorder {
namespace {

TEST(RecordName, IsTimeSubjectAndKind) {
  EXPECT_EQ(to_text({wall_at(0) + std::chrono::milliseconds(678), "pump1", "emcy"}), "20260102T030405.678Z-pump1-emcy");
}

TEST(RecordName, IsReadAsItWasWritten) {
  for (const char* subject : {"pump1", "a", "-", "a-b_C-9", "-heartbeat-", "abcdefghijklmnopqrstuvwxyz012345"}) {
    for (const char* kind : {"emcy", "heartbeat", "boot", "data", "control", "bus", "request"}) {
      const RecordName name{wall_at(77), subject, kind};
      EXPECT_EQ(parse_record_name(to_text(name)), name) << to_text(name);
    }
  }
}

TEST(RecordName, IsNothingElse) {
  for (const char* text :
       {"", "-", "--", "emcy", "20260102T030405.678Z", "20260102T030405.678Z-emcy", "20260102T030405.678Z--emcy",
        "20260102T030405.678Z-pump1-", "20260102T030405.678Z-pump1-else", "20260102T030405.678Z-pump1-emcy.log",
        "20260102T030405.678Z-../x-emcy", "20260102T030405.678Z-pump 1-emcy", "20260102T030405.678Z-pump\n-emcy",
        "20261302T030405.678Z-pump1-emcy", "20260102t030405.678z-pump1-emcy", "2026-01-02T030405678Z-pump1-emcy",
        " 20260102T030405.678Z-pump1-emcy", "20260102T030405.678Z_pump1-emcy",
        "20260102T030405.678Z-abcdefghijklmnopqrstuvwxyz0123456-emcy"}) {
    EXPECT_FALSE(parse_record_name(text)) << text;
  }
}

}  // namespace
}  // namespace recorder
