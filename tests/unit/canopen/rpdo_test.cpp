#include "canopen/node/rpdo.h"

#include <gtest/gtest.h>

#include <vector>

namespace canopen {
namespace {

constexpr ObjectAddress kControl{0x2030, 2};
constexpr ObjectAddress kFrequency{0x2030, 1};
constexpr ObjectAddress kTorque{0x2030, 6};

using Fields = std::vector<ObjectValue>;

ObjectValue value(ObjectAddress object, Raw raw) {
  return {object, DataType::u16, raw};
}

// RPDO1 of the AC300CAN1: control, frequency, torque; six bytes.
PdoSettings veichi_rpdo1() {
  return {.number = 1,
          .cob_id = 0x205,
          .mapping = {{.object = kControl}, {.object = kFrequency}, {.object = kTorque, .type = DataType::i16}}};
}

void send(Rpdo& rpdo, const Fields& fields) {
  const auto draft = rpdo.build(fields);
  ASSERT_TRUE(draft);
  rpdo.confirm(*draft, fields);
}

std::vector<std::uint8_t> bytes_of(const Frame& frame) {
  return {frame.bytes().begin(), frame.bytes().end()};
}

TEST(Rpdo, IsIncompleteUntilEveryFieldWasCommanded) {
  Rpdo rpdo(veichi_rpdo1());
  EXPECT_FALSE(rpdo.complete(Fields{}));
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 3000)}));
  EXPECT_EQ(rpdo.build(Fields{value(kFrequency, 3000)}), std::nullopt);

  rpdo.note(value(kFrequency, 3000));
  rpdo.note(value(kTorque, 0));
  EXPECT_FALSE(rpdo.complete(Fields{}));
  EXPECT_TRUE(rpdo.complete(Fields{value(kControl, 1)}));
}

TEST(Rpdo, FieldsTogetherCompleteIt) {
  Rpdo rpdo(veichi_rpdo1());
  const Fields fields{value(kFrequency, 5000), value(kTorque, static_cast<Raw>(-1)), value(kControl, 1)};
  const auto draft = rpdo.build(fields);
  ASSERT_TRUE(draft);
  EXPECT_EQ(draft->frame.id, 0x205U);
  EXPECT_EQ(bytes_of(draft->frame), (std::vector<std::uint8_t>{0x01, 0x00, 0x88, 0x13, 0xFF, 0xFF}));
}

TEST(Rpdo, BuildingCommandsNothing) {
  Rpdo rpdo(veichi_rpdo1());
  const Fields fields{value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)};
  ASSERT_TRUE(rpdo.build(fields));
  EXPECT_FALSE(rpdo.complete(Fields{}));
  EXPECT_EQ(rpdo.last_confirmed(), std::nullopt);
}

TEST(Rpdo, AConfirmedFrameMakesItsFieldsKnown) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)});
  const auto next = rpdo.build(Fields{value(kFrequency, 4000)});
  ASSERT_TRUE(next);
  EXPECT_EQ(bytes_of(next->frame), (std::vector<std::uint8_t>{0x01, 0x00, 0xA0, 0x0F, 0x00, 0x00}));
  EXPECT_EQ(bytes_of(rpdo.last_confirmed().value()), (std::vector<std::uint8_t>{0x01, 0x00, 0x88, 0x13, 0x00, 0x00}));
}

TEST(Rpdo, VoidForgetsEverything) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)});
  rpdo.make_void();
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
  EXPECT_EQ(rpdo.last_confirmed(), std::nullopt);
}

TEST(Rpdo, AtStandstillASupervisedDriveIsStillRepeatedTo) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 5)});
  const auto repeated = rpdo.last_confirmed();
  rpdo.make_void_but_repeat();
  EXPECT_EQ(rpdo.last_confirmed(), repeated);
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
}

TEST(Rpdo, VoidWhileAFrameIsOnItsWayHolds) {
  Rpdo rpdo(veichi_rpdo1());
  const Fields fields{value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)};
  const auto draft = rpdo.build(fields);
  ASSERT_TRUE(draft);
  rpdo.make_void();
  rpdo.confirm(*draft, fields);
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
  EXPECT_EQ(rpdo.last_confirmed(), std::nullopt);
}

TEST(Rpdo, StandstillWhileAFrameIsOnItsWayRepeatsThatFrame) {
  Rpdo rpdo(veichi_rpdo1());
  const Fields fields{value(kFrequency, 5000), value(kTorque, 0), value(kControl, 5)};
  const auto draft = rpdo.build(fields);
  ASSERT_TRUE(draft);
  rpdo.make_void_but_repeat();
  rpdo.confirm(*draft, fields);
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
  EXPECT_EQ(rpdo.last_confirmed(), draft->frame);
}

TEST(Rpdo, AnUnknownOutcomeUnknowsItsFieldsOnly) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)});
  const Fields stop{value(kControl, 5)};
  ASSERT_TRUE(rpdo.build(stop));
  rpdo.outcome_unknown(stop);
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
  EXPECT_TRUE(rpdo.complete(stop));
  // The drive may have stopped: repeating the frame before would start it again.
  EXPECT_EQ(rpdo.last_confirmed(), std::nullopt);
}

TEST(Rpdo, AMomentaryValueIsForgottenAndNotRepeated) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 7)});
  rpdo.forget(kControl);
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
  EXPECT_TRUE(rpdo.complete(Fields{value(kControl, 1)}));
  EXPECT_EQ(rpdo.last_confirmed(), std::nullopt);
}

TEST(Rpdo, RepetitionDoesNotUndoAnSdoWrite) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, static_cast<Raw>(-1)), value(kControl, 1)});
  rpdo.note(value(kFrequency, 4000));
  EXPECT_EQ(bytes_of(rpdo.last_confirmed().value()), (std::vector<std::uint8_t>{0x01, 0x00, 0xA0, 0x0F, 0xFF, 0xFF}));
}

TEST(Rpdo, UnusedFieldsAreZeroAndNotCommanded) {
  PdoSettings settings = veichi_rpdo1();
  settings.mapping[2].use = FieldUse::unused;
  Rpdo rpdo(settings);
  EXPECT_FALSE(rpdo.maps(kTorque));
  EXPECT_FALSE(rpdo.complete(Fields{value(kControl, 1), value(kFrequency, 5000), value(kTorque, 9)}));
  const auto draft = rpdo.build(Fields{value(kControl, 1), value(kFrequency, 5000)});
  ASSERT_TRUE(draft);
  EXPECT_EQ(bytes_of(draft->frame), (std::vector<std::uint8_t>{0x01, 0x00, 0x88, 0x13, 0x00, 0x00}));
}

TEST(Rpdo, AnUnnamedFieldMakesItNeverComplete) {
  PdoSettings settings = veichi_rpdo1();
  settings.mapping[2].use = FieldUse::unnamed;
  Rpdo rpdo(settings);
  rpdo.note(value(kTorque, 0));
  EXPECT_FALSE(rpdo.complete(Fields{value(kControl, 1), value(kFrequency, 5000)}));
  EXPECT_EQ(rpdo.build(Fields{value(kControl, 1), value(kFrequency, 5000), value(kTorque, 0)}), std::nullopt);
}

TEST(Rpdo, AForeignObjectIsNeverDroppedSilently) {
  Rpdo rpdo(veichi_rpdo1());
  EXPECT_FALSE(
      rpdo.complete(Fields{value(kControl, 1), value(kFrequency, 1), value(kTorque, 1), value({0x2030, 5}, 1)}));
}

TEST(Rpdo, AnEmptyMappingIsNeverSent) {
  Rpdo rpdo(PdoSettings{.cob_id = 0x205});
  EXPECT_EQ(rpdo.build(Fields{}), std::nullopt);
}

}  // namespace
}  // namespace canopen
