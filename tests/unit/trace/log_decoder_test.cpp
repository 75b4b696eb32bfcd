#include "bridges/trace/log_decoder.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/unit/trace/site.h"

namespace trace {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class TraceLog : public testing::Test {
 protected:
  LogDecoder decoder(const FilterWords& words = {}, bool raw = false) {
    return {model_,
            make_filter(model_, words).value(),
            raw,
            {.line = [this](const std::string& text) { lines_.push_back(text); },
             .complaint = [this](const std::string& text) { complaints_.push_back(text); }}};
  }

  config::Model model_ = test::site();
  std::vector<std::string> lines_;
  std::vector<std::string> complaints_;
};

const std::string kLog =
    "(1767323045.000001) can0 705#05\n"
    "\r\n"
    "(1767323045.000002) can1 706#7F\r\n"
    "(1767323045.000003) vcan7 705#05\n"
    "nonsense\n"
    "(1767323045.000004) can0 605#4021200200000000 T\n"
    "(1767323045.000005) can0 585#4B21200285130000";

TEST_F(TraceLog, IsDecodedByTheConfiguration) {
  LogDecoder log = decoder();
  log.take(kLog);
  log.finish();
  EXPECT_THAT(lines_, ElementsAre("03:04:05.000001 can0  705 pump1      heartbeat operational",
                                  "03:04:05.000002 can1  706 winder1    heartbeat pre-operational",
                                  "03:04:05.000003 vcan7  705 node 5     heartbeat operational",
                                  "03:04:05.000004 can0 >605 pump1      SDO       read 0x2021:02 output_frequency",
                                  "03:04:05.000005 can0  585 pump1      SDO       answer: 0x2021:02 output_frequency = "
                                  "49.97 Hz"));
  EXPECT_THAT(complaints_, ElementsAre(HasSubstr("line 5: does not begin with a time")));
  EXPECT_EQ(log.bad(), 1U);
}

TEST_F(TraceLog, InPiecesItIsTheSame) {
  LogDecoder whole = decoder();
  whole.take(kLog);
  whole.finish();
  const std::vector<std::string> expected = std::exchange(lines_, {});
  LogDecoder pieces = decoder();
  for (const char letter : kLog) {
    pieces.take({&letter, 1});
  }
  pieces.finish();
  EXPECT_EQ(lines_, expected);
}

TEST_F(TraceLog, RawAndChosen) {
  LogDecoder log = decoder({.names = "pump1", .kinds = "sdo"}, true);
  log.take(kLog);
  log.finish();
  EXPECT_THAT(lines_, ElementsAre("(1767323045.000004) can0 605#4021200200000000",
                                  "(1767323045.000005) can0 585#4B21200285130000"));
}

TEST_F(TraceLog, OfInProcessBusesIsToldByTheirNames) {
  model_.buses[0].interface = model_.buses[1].interface = config::kVirtualInterface;
  LogDecoder log = decoder();
  log.take(
      "(1767323045.000001) can1 706#7F\n"
      "(1767323045.000001) can0 705#05\n"
      "(1767323045.000001) virtual 705#05\n");
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("winder1"), HasSubstr("pump1"), HasSubstr("node 5")))
      << "what names each of them names none";
}

TEST_F(TraceLog, AnInterfaceGoesBeforeTheNameOfAnotherBus) {
  model_.buses[0].name = "can1";
  model_.buses[1].name = "can0";
  LogDecoder log = decoder();
  log.take("(1767323045.000001) can0 705#05\n");
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("pump1")));
}

TEST_F(TraceLog, WhereThereIsOneBusAllFramesAreOfIt) {
  model_.buses.pop_back();
  model_.drives.pop_back();
  LogDecoder log = decoder();
  log.take("(1767323045.000001) vcan7 705#05\n");
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("pump1")));
}

TEST_F(TraceLog, WhatIsNoLogIsToldInFewWordsAndTakesNoMemory) {
  LogDecoder log = decoder();
  for (int i = 0; i < 1000; ++i) {
    log.take(std::string(100'000, 'x'));
  }
  EXPECT_THAT(complaints_, IsEmpty());
  log.take("\n" + std::string(60, '\n') + std::string("y\n"));
  for (int i = 0; i < 50; ++i) {
    log.take("z\n");
  }
  log.finish();
  ASSERT_THAT(complaints_, SizeIs(21));
  EXPECT_THAT(complaints_.front(), HasSubstr("line 1: longer than a line of candump"));
  EXPECT_THAT(complaints_.back(), HasSubstr("32 further lines"));
  EXPECT_EQ(log.bad(), 52U);
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(TraceLog, InterfacesAreNotWithoutEnd) {
  LogDecoder log = decoder();
  for (int i = 0; i < 100; ++i) {
    log.take("(1767323045.000001) x" + std::to_string(i) + " 705#05\n");
  }
  EXPECT_THAT(lines_, SizeIs(64));
  EXPECT_EQ(log.bad(), 36U);
}

}  // namespace
}  // namespace trace
