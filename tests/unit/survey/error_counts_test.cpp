#include "canopen/survey/error_counts.h"

#include <gtest/gtest.h>
#include <linux/can/error.h>

namespace canopen {
namespace {

Frame error_frame(std::uint32_t classes, unsigned kind, unsigned place) {
  Frame frame{.id = classes, .size = 8, .error = true};
  frame.data[2] = static_cast<std::uint8_t>(kind);
  frame.data[3] = static_cast<std::uint8_t>(place);
  return frame;
}

struct Case {
  const char* what;
  std::uint32_t classes;
  unsigned kind;
  unsigned place;
  ErrorCounts counts;
};

TEST(ErrorCounts, EachKindIsRead) {
  constexpr std::uint32_t kProtocol = CAN_ERR_PROT | CAN_ERR_BUSERROR;
  const Case cases[] = {
      {"bit", kProtocol, CAN_ERR_PROT_BIT, 0, {.bit = 1, .wire = 1}},
      {"dominant bit", kProtocol, CAN_ERR_PROT_BIT0, 0, {.bit = 1, .wire = 1}},
      {"recessive bit", kProtocol, CAN_ERR_PROT_BIT1 | CAN_ERR_PROT_TX, 0, {.bit = 1, .wire = 1}},
      {"stuff", kProtocol, CAN_ERR_PROT_STUFF, 0x0A, {.stuff = 1, .wire = 1}},
      {"form", kProtocol, CAN_ERR_PROT_FORM, CAN_ERR_PROT_LOC_CRC_DEL, {.form = 1, .wire = 1}},
      {"form and stuff", kProtocol, CAN_ERR_PROT_FORM | CAN_ERR_PROT_STUFF, 0, {.stuff = 1, .form = 1, .wire = 1}},
      {"CRC by its place (m_can)", kProtocol, 0, CAN_ERR_PROT_LOC_CRC_SEQ, {.crc = 1, .wire = 1}},
      {"CRC of slcan", kProtocol, CAN_ERR_PROT_BIT, CAN_ERR_PROT_LOC_CRC_SEQ, {.crc = 1, .wire = 1}},
      {"no acknowledgement", CAN_ERR_ACK, 0, 0, {.ack = 1}},
      {"no acknowledgement, slcan", kProtocol | CAN_ERR_ACK, 0, CAN_ERR_PROT_LOC_ACK, {.ack = 1}},
      {"no acknowledgement by its place (sja1000)", kProtocol, CAN_ERR_PROT_TX, CAN_ERR_PROT_LOC_ACK, {.ack = 1}},
      {"an overrun", CAN_ERR_CRTL, 0, 0, {}},
      {"bus-off", CAN_ERR_BUSOFF, 0, 0, {}},
      {"lost arbitration", CAN_ERR_LOSTARB, 0, 0, {}},
      {"overload frame", kProtocol, CAN_ERR_PROT_OVERLOAD, 0, {}},
      {"bytes of another class", CAN_ERR_CRTL, CAN_ERR_PROT_FORM, CAN_ERR_PROT_LOC_ACK, {}}};
  for (const Case& each : cases) {
    EXPECT_EQ(error_counts_of(error_frame(each.classes, each.kind, each.place)), each.counts) << each.what;
  }
}

TEST(ErrorCounts, TheMostComeFirst) {
  EXPECT_EQ(text_of({}), "");
  EXPECT_EQ(text_of({.bit = 2, .stuff = 26, .form = 31, .crc = 2, .ack = 1, .wire = 61}),
            "31 form, 26 stuff, 2 CRC, 2 bit, 1 no acknowledgement");
}

}  // namespace
}  // namespace canopen
