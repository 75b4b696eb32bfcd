#include "tests/support/tshark.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/unit/trace/site.h"

// tshark is nobody of ours: what it can tell of a frame, the trace says, too.

namespace trace {
namespace {

struct Case {
  std::string frame;
  std::string tshark;
  std::string ours;  ///< Without the object and its value.
};

const std::vector<Case> kCases{
    {"605#4021200200000000", "Default-SDO (rx): Initiate upload request", "SDO: read "},
    {"585#4B21200285130000", "Default-SDO (tx): Initiate upload response", "SDO: answer: "},
    {"605#2B171000F4010000", "Default-SDO (rx): Initiate download request", "SDO: write "},
    {"585#6017100000000000", "Default-SDO (tx): Initiate download response", " written"},
    {"585#8021200200000206", "Default-SDO (tx): Abort transfer", "SDO: answer: 0x2021:02 output_frequency: abort "},
    {"605#8021200200000405", "Default-SDO (rx): Abort transfer", "SDO: 0x2021:02 output_frequency: abort "},
    {"605#6000000000000000", "Default-SDO (rx): Upload segment request", "next segment asked for"},
    {"585#0041433331302D56", "Default-SDO (tx): Upload segment response",
     "answer: an object that was not seen: segment"},
    {"605#2110200108000000", "Default-SDO (rx): Initiate download request", "8 bytes follow in segments"},
    {"605#0001020304050607", "Default-SDO (rx): Download segment request", "write 0x2010:01: segment of 7 bytes"},
    {"585#2000000000000000", "Default-SDO (tx): Download segment response", "segment taken"},
    {"000#0105", "NMT: Start remote node [0x5]", "NMT: start: pump1 (node 5)"},
    {"000#0205", "NMT: Stop remote node [0x5]", "NMT: stop: pump1 (node 5)"},
    {"000#8005", "NMT: Enter pre-operational state [0x5]", "NMT: pre-operational: pump1 (node 5)"},
    {"000#8100", "NMT: Reset node [All]", "NMT: reset-node: all nodes"},
    {"000#8205", "NMT: Reset communication [0x5]", "NMT: reset-communication: pump1 (node 5)"},
    {"705#00", "NMT Error Control: Boot-up [0x5]", "heartbeat: boot-up"},
    {"705#04", "NMT Error Control: Stopped [0x5]", "heartbeat: stopped"},
    {"705#05", "NMT Error Control: Operational [0x5]", "heartbeat: operational"},
    {"705#7F", "NMT Error Control: Pre-operational [0x5]", "heartbeat: pre-operational"},
    {"085#0000000000000000", "EMCY", "EMCY: "},
    {"080#", "SYNC", "SYNC"},
    {"185#0102030405060708", "PDO1 (tx)", "TPDO1: "},
    {"385#0102030405060708", "PDO3 (tx)", "TPDO3: "},
    {"305#0102", "PDO2 (rx)", "RPDO2: "}};

TEST(TraceAndTshark, SayTheSame) {
  test::Listener listener;
  std::vector<canopen::Received> frames;
  std::vector<std::string> words;
  for (const Case& each : kCases) {
    frames.push_back({listener.hear(each.frame).frame, canopen::TimePoint{}, canopen::wall_now()});
  }
  test::Listener again;
  const std::vector<support::Decoded> decoded = support::decode_by_tshark(frames);
  ASSERT_EQ(decoded.size(), kCases.size());
  for (std::size_t i = 0; i < kCases.size(); ++i) {
    EXPECT_EQ(decoded[i].info, kCases[i].tshark) << kCases[i].frame;
    EXPECT_FALSE(decoded[i].malformed) << kCases[i].frame;
    EXPECT_THAT(again.words(kCases[i].frame), testing::HasSubstr(kCases[i].ours));
  }
}

}  // namespace
}  // namespace trace
