#include <gmock/gmock.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/unit/trace/site.h"

// The manuals' own examples: what tests/golden/README.md says of each frame is what the trace says.

namespace trace {
namespace {

using testing::ElementsAre;

std::vector<std::string> words_of_log(const std::string& name) {
  std::ifstream in(GATEWAY_SOURCE_DIR "/tests/golden/" + name + ".log");
  EXPECT_TRUE(in.good()) << name;
  test::Listener listener;
  std::vector<std::string> words;
  for (std::string line; std::getline(in, line);) {
    words.push_back(listener.words(line.substr(line.rfind(' ') + 1)));
  }
  return words;
}

TEST(GoldenWords, Goodrive600) {
  EXPECT_THAT(words_of_log("goodrive600-boot-up"), ElementsAre("hoist1 heartbeat: boot-up"));
  EXPECT_THAT(
      words_of_log("goodrive600-heartbeat"),
      ElementsAre("hoist1 heartbeat: operational", "hoist1 heartbeat: operational", "hoist1 heartbeat: operational"));
  EXPECT_THAT(words_of_log("goodrive600-heartbeat-disable"),
              ElementsAre("hoist1 SDO: write 0x1017:00 producer heartbeat time = 0, off"));
  EXPECT_THAT(words_of_log("goodrive600-sync"), ElementsAre("SYNC"));
  EXPECT_THAT(
      words_of_log("goodrive600-emcy-out1"),
      ElementsAre("hoist1 EMCY: 0x3000 fault: OUt1: inverter unit, phase U; error register 0x04 (voltage), vendor "
                  "bytes 01 00 00 00 00",
                  "hoist1 EMCY: 0x0000, an error is over; error register 0x00 (no error), vendor bytes 00 00 00 "
                  "00 00"));
  EXPECT_THAT(words_of_log("goodrive600-sdo-read-1801-03"),
              ElementsAre("hoist1 SDO: read 0x1801:03 TPDO2 inhibit time",
                          "hoist1 SDO: answer: 0x1801:03 TPDO2 inhibit time = 0x000003E8 (1000)"));
  EXPECT_THAT(
      words_of_log("goodrive600-rpdo2-50hz"),
      ElementsAre("hoist1 RPDO2: control_command 0x0001, 0x2100:03 0x0000 (unused), frequency_command 50.00 Hz, "
                  "0x2100:05 0x0000 (unused)"));
  EXPECT_THAT(words_of_log("goodrive600-parameter-channel"),
              ElementsAre("hoist1 RPDO1: 02 00 0D 0F 01 00 (not configured)",
                          "hoist1 TPDO1: 01 00 00 00 01 00 00 00 (not configured)"));
}

TEST(GoldenWords, Opte6) {
  EXPECT_THAT(words_of_log("opte6-reset-communication"),
              ElementsAre("mixer1 NMT: reset-communication: mixer1 (node 4)", "mixer1 heartbeat: boot-up"));
  EXPECT_THAT(words_of_log("opte6-heartbeat-states"),
              ElementsAre("mixer1 heartbeat: boot-up", "mixer1 heartbeat: stopped", "mixer1 heartbeat: operational",
                          "mixer1 heartbeat: pre-operational"));
}

TEST(GoldenWords, Veichi) {
  EXPECT_THAT(words_of_log("veichi-heartbeat-states"),
              ElementsAre("fan1 heartbeat: stopped", "fan1 heartbeat: operational", "fan1 heartbeat: pre-operational"));
  EXPECT_THAT(words_of_log("veichi-nmt-commands"),
              ElementsAre("fan1 NMT: start: fan1 (node 2)", "fan1 NMT: stop: fan1 (node 2)",
                          "fan1 NMT: pre-operational: fan1 (node 2)", "fan1 NMT: reset-node: fan1 (node 2)",
                          "fan1 NMT: reset-communication: fan1 (node 2)"));
}

TEST(GoldenWords, VeichiShortAndOddAnswers) {
  EXPECT_THAT(
      words_of_log("veichi-sdo-read-c00-26-short"),
      ElementsAre("fan1 SDO: read 0x2021:1B rated_voltage", "fan1 SDO: answer: 0x2021:1B rated_voltage = 220 V"));
  EXPECT_THAT(words_of_log("veichi-sdo-read-3006-short"),
              ElementsAre("fan1 SDO: read 0x2030:07", "fan1 SDO: answer: 0x2030:07 = 0x0000 (0)"));
  EXPECT_THAT(words_of_log("veichi-sdo-write-3006-short"),
              ElementsAre("fan1 SDO: write 0x2030:07 = 0x0064 (100)", "fan1 SDO: answer: 0x2030:07 written"));
  EXPECT_THAT(words_of_log("veichi-sdo-read-f02-02"),
              ElementsAre("fan1 SDO: read 0x2002:03", "fan1 SDO: answer: 0x2002:03 = 0x0000 (0)"));
  EXPECT_THAT(words_of_log("veichi-sdo-write-f02-02"),
              ElementsAre("fan1 SDO: write 0x2002:03 = 0x0003 (3)", "fan1 SDO: answer: 0x2002:03 written"))
      << "answered in the form of a read";
}

TEST(GoldenWords, BlocksAreFollowedToTheirEnd) {
  const std::string text = "\"Frequency inverter, 5.5 kW, firmware 1.07\"";
  const std::vector<std::string> upload = words_of_log("sdo-block-upload");
  ASSERT_EQ(upload.size(), 12U);
  EXPECT_EQ(upload[0], "pump1 SDO: read 0x1008:00 device name in blocks of up to 31 segments");
  EXPECT_EQ(upload[1], "pump1 SDO: answer: 0x1008:00 device name: 41 bytes follow in blocks");
  EXPECT_EQ(upload[8], "pump1 SDO: answer: 0x1008:00 device name: block segment 6, the last");
  EXPECT_EQ(upload[9], "pump1 SDO: 0x1008:00 device name: block taken up to segment 6");
  EXPECT_EQ(upload[10], "pump1 SDO: answer: 0x1008:00 device name: end of block transfer, 41 bytes in all: " + text);
  EXPECT_EQ(upload[11], "pump1 SDO: 0x1008:00 device name: block transfer done");
  const std::vector<std::string> download = words_of_log("sdo-block-download");
  ASSERT_EQ(download.size(), 12U);
  EXPECT_EQ(download[0], "pump1 SDO: write 0x2000:01: 41 bytes follow in blocks");
  EXPECT_EQ(download[6], "pump1 SDO: answer: 0x2000:01: block taken up to segment 4");
  EXPECT_EQ(download[7], "pump1 SDO: 0x2000:01: block segment 1");
  EXPECT_EQ(download[10], "pump1 SDO: 0x2000:01: end of block transfer, 41 bytes in all: " + text);
  EXPECT_EQ(download[11], "pump1 SDO: answer: 0x2000:01: block transfer done");
}

}  // namespace
}  // namespace trace
