#include "canopen/survey/suspicion.h"

#include <gmock/gmock.h>

namespace canopen {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A bus with traffic and nothing wrong.
Signs clean() {
  return {.state = {.condition = BusCondition::error_active},
          .lately = {.errors = {}, .received = 1000},
          .minute = {.errors = {}, .received = 6000},
          .heard_before = true,
          .load_per_mille = 250,
          .bitrate = 250'000};
}

std::string kind_of(const Signs& signs) {
  const std::optional<Suspicion> judged = judge(signs);
  return judged ? std::string(name_of(judged->kind)) : "none";
}

TEST(Suspicion, OfACleanBusThereIsNone) {
  EXPECT_EQ(kind_of(clean()), "none");
  Signs few = clean();
  few.minute.errors = {.stuff = 9, .wire = 9};
  EXPECT_EQ(kind_of(few), "none") << "a plug was moved";
  Signs long_lasting = clean();
  long_lasting.minute = {.errors = {.stuff = 11, .wire = 11}, .received = 12'000};
  EXPECT_EQ(kind_of(long_lasting), "none") << "less than one in a thousand";
  Signs silent = clean();
  silent.lately = silent.minute = {};
  silent.heard_before = false;
  EXPECT_EQ(kind_of(silent), "none") << "nobody sends, and nothing disturbs";
  Signs warned = clean();
  warned.state = {.condition = BusCondition::warning, .transmit_errors = 0, .receive_errors = 100};
  EXPECT_EQ(kind_of(warned), "none") << "once is no pattern";
}

TEST(Suspicion, OfAnInterfaceThatIsDownThereIsNone) {
  Signs signs = clean();
  signs.state.condition = BusCondition::down;
  signs.minute.errors.wire = 1000;
  signs.troubles.own_node_id = true;
  EXPECT_EQ(kind_of(signs), "none");
}

TEST(Suspicion, AloneWhereNobodyAcknowledgesAndNothingDisturbs) {
  Signs signs = clean();
  signs.state = {.condition = BusCondition::passive, .transmit_errors = 128, .receive_errors = 0};
  signs.troubles.transmit = TransmitTrouble::not_acknowledged;
  signs.lately = {.errors = {.ack = 300}, .received = 0};
  EXPECT_EQ(kind_of(signs), "alone");
  EXPECT_THAT(judge(signs)->text(),
              HasSubstr("the gateway may be alone on the bus: nobody acknowledges our frames and nobody else is heard, "
                        "but nothing disturbs either; the controller is error-passive (128 transmit, 0 receive "
                        "errors). Look first at whether the drives have power"));
  signs.lately.errors.wire = 1;
  EXPECT_NE(kind_of(signs), "alone") << "something disturbs";
  signs.lately.errors.wire = 0;
  signs.bus_offs = 1;
  EXPECT_NE(kind_of(signs), "alone") << "a missing acknowledgement never leads to bus-off";
}

TEST(Suspicion, BitRateWhereNothingWasEverReadableAndMuchDisturbs) {
  Signs signs = clean();
  signs.heard_before = false;
  signs.state = {.condition = BusCondition::passive, .transmit_errors = 0, .receive_errors = 135};
  signs.lately = {.errors = {.stuff = 26, .form = 31, .wire = 57}, .received = 0};
  signs.minute = signs.lately;
  EXPECT_EQ(kind_of(signs), "bit_rate");
  EXPECT_EQ(
      judge(signs)->text(),
      "the bit rate may be wrong: no frame was received since the gateway opened the interface; the controller is "
      "error-passive (0 transmit, 135 receive errors); 57 errors in the last minute (31 form, 26 stuff). Look "
      "first at the bit rate, here 250000 bit/s, and that of each drive; then at CAN_H and CAN_L that are swapped "
      "or touch each other, and where the bus worked before at its cable, plugs and terminators");
  signs.saw_it_come_up = true;
  EXPECT_THAT(judge(signs)->seen, HasSubstr("since the interface came up; "));
  signs.lately = signs.minute = {};
  EXPECT_EQ(kind_of(signs), "bit_rate") << "few drivers tell of single errors";
  signs.state = {.condition = BusCondition::bus_off};
  EXPECT_EQ(kind_of(signs), "bit_rate");
  signs.state = {.condition = BusCondition::error_active};
  EXPECT_EQ(kind_of(signs), "none");
  signs.bus_offs = 1;
  EXPECT_EQ(kind_of(signs), "bit_rate") << "it restarts by itself, and goes off again";
}

TEST(Suspicion, WiringWhereFramesComeAndErrorsToo) {
  Signs signs = clean();
  signs.minute.errors = {.bit = 4, .stuff = 6, .wire = 10};
  EXPECT_EQ(kind_of(signs), "wiring");
  EXPECT_THAT(judge(signs)->text(),
              HasSubstr("wiring or termination may be bad: 10 errors in the last minute (6 stuff, 4 bit); 6000 frames "
                        "received in the last minute; the controller is error-active (0 transmit, 0 receive errors). "
                        "Look first at the two terminators"));
  signs = clean();
  signs.excursions = true;
  EXPECT_EQ(kind_of(signs), "wiring");
}

TEST(Suspicion, WiringWhereWhatWasReadableIsNoMore) {
  Signs signs = clean();
  signs.lately.received = 0;
  EXPECT_EQ(kind_of(signs), "none") << "silence is no error";
  signs.state.condition = BusCondition::bus_off;
  EXPECT_EQ(kind_of(signs), "wiring");
  EXPECT_THAT(judge(signs)->text(), HasSubstr("frames were received before, and none in the last 10 s"));
  signs.state.condition = BusCondition::error_active;
  signs.lately.errors = {.form = 5, .wire = 5};
  EXPECT_EQ(kind_of(signs), "wiring");
}

TEST(Suspicion, ADoubledIdExplainsErrorsToo) {
  Signs signs = clean();
  signs.minute.errors = {.bit = 400, .wire = 400};
  signs.doubled = DoubledSign{.node = 5, .text = "heartbeats come at twice their rate"};
  EXPECT_EQ(kind_of(signs), "doubled_id");
  EXPECT_THAT(judge(signs)->text(),
              HasSubstr("a node id may be there twice: node 5: heartbeats come at twice their rate. Look first at"));
  signs.doubled.reset();
  signs.troubles.own_node_id = true;
  EXPECT_EQ(kind_of(signs), "doubled_id");
  EXPECT_THAT(judge(signs)->text(), HasSubstr("the gateway's node id"));
}

TEST(Suspicion, OverloadIsJudgedWhereTheBusAlarmIs) {
  Signs signs = clean();
  signs.troubles.overload = true;
  signs.load_per_mille = 934;
  signs.busiest = "0x185, every 0.5 ms";
  EXPECT_EQ(judge(signs)->text(),
            "the bus may be overloaded: load 93 %; the most frequent COB-ID is 0x185, every 0.5 ms. Look first at "
            "inhibit times and periods of the TPDOs that come most often, then at the bit rate");
  signs.troubles.overload = false;
  EXPECT_EQ(kind_of(signs), "none") << "a high load alone is a choice";
  signs.troubles.transmit = TransmitTrouble::stuck;
  EXPECT_EQ(kind_of(signs), "overload");
  signs.load_per_mille = 300;
  EXPECT_EQ(kind_of(signs), "none") << "what waits has another reason";
}

TEST(Suspicion, NoSentenceIsCertain) {
  for (const SuspicionKind kind : kSuspicionKinds) {
    EXPECT_THAT(std::string(describe(kind)), HasSubstr(" may be "));
    EXPECT_THAT(std::string(name_of(kind)), Not(testing::IsEmpty()));
  }
}

}  // namespace
}  // namespace canopen
