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
  ASSERT_TRUE(rpdo.begin(fields));
  rpdo.left();
}

std::vector<std::uint8_t> bytes_of(const Frame& frame) {
  return {frame.bytes().begin(), frame.bytes().end()};
}

TEST(Rpdo, IsIncompleteUntilEveryFieldWasCommanded) {
  Rpdo rpdo(veichi_rpdo1());
  EXPECT_FALSE(rpdo.complete(Fields{}));
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 3000)}));
  EXPECT_EQ(rpdo.begin(Fields{value(kFrequency, 3000)}), std::nullopt);

  rpdo.note(value(kFrequency, 3000));
  rpdo.note(value(kTorque, 0));
  EXPECT_FALSE(rpdo.complete(Fields{}));
  EXPECT_TRUE(rpdo.complete(Fields{value(kControl, 1)}));
}

TEST(Rpdo, FieldsTogetherCompleteIt) {
  Rpdo rpdo(veichi_rpdo1());
  const Fields fields{value(kFrequency, 5000), value(kTorque, static_cast<Raw>(-1)), value(kControl, 1)};
  const auto frame = rpdo.begin(fields);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->id, 0x205U);
  EXPECT_EQ(bytes_of(*frame), (std::vector<std::uint8_t>{0x01, 0x00, 0x88, 0x13, 0xFF, 0xFF}));
}

TEST(Rpdo, BuildingCommandsNothing) {
  Rpdo rpdo(veichi_rpdo1());
  const Fields fields{value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)};
  ASSERT_TRUE(rpdo.begin(fields));
  EXPECT_FALSE(rpdo.complete(Fields{}));
  EXPECT_EQ(rpdo.repeated(), std::nullopt);
}

TEST(Rpdo, AConfirmedFrameMakesItsFieldsKnown) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)});
  const auto next = rpdo.begin(Fields{value(kFrequency, 4000)});
  ASSERT_TRUE(next);
  EXPECT_EQ(bytes_of(*next), (std::vector<std::uint8_t>{0x01, 0x00, 0xA0, 0x0F, 0x00, 0x00}));
  EXPECT_EQ(bytes_of(rpdo.repeated().value()), (std::vector<std::uint8_t>{0x01, 0x00, 0x88, 0x13, 0x00, 0x00}));
}

TEST(Rpdo, VoidForgetsEverything) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)});
  rpdo.make_void(false);
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
  EXPECT_EQ(rpdo.repeated(), std::nullopt);
}

TEST(Rpdo, AtStandstillASupervisedDriveIsStillRepeatedTo) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 5)});
  const auto repeated = rpdo.repeated();
  rpdo.make_void(true);
  EXPECT_EQ(rpdo.repeated(), repeated);
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
}

TEST(Rpdo, VoidWhileAFrameIsOnItsWayHolds) {
  Rpdo rpdo(veichi_rpdo1());
  const Fields fields{value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)};
  const auto frame = rpdo.begin(fields);
  ASSERT_TRUE(frame);
  rpdo.make_void(false);
  rpdo.left();
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
  EXPECT_EQ(rpdo.repeated(), std::nullopt);
}

TEST(Rpdo, StandstillWhileAFrameIsOnItsWayRepeatsThatFrame) {
  Rpdo rpdo(veichi_rpdo1());
  const Fields fields{value(kFrequency, 5000), value(kTorque, 0), value(kControl, 5)};
  const auto frame = rpdo.begin(fields);
  ASSERT_TRUE(frame);
  rpdo.make_void(true);
  rpdo.left();
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
  EXPECT_EQ(rpdo.repeated(), *frame);
}

TEST(Rpdo, AnSdoWriteWhileAFrameIsOnItsWayMakesThatCountForNothing) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)});
  ASSERT_TRUE(rpdo.begin(Fields{value(kFrequency, 4000)}));
  rpdo.note(value(kTorque, 7));
  rpdo.left();
  EXPECT_FALSE(rpdo.complete(Fields{}));
  EXPECT_EQ(rpdo.repeated(), std::nullopt);
  const auto next = rpdo.begin(Fields{value(kFrequency, 3000)});
  ASSERT_TRUE(next) << "what is not in that frame's fields is still known";
  EXPECT_EQ(bytes_of(*next), (std::vector<std::uint8_t>{0x01, 0x00, 0xB8, 0x0B, 0x07, 0x00}));
}

TEST(Rpdo, AForgottenFieldWhileAFrameIsOnItsWayMakesThatCountForNothing) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)});
  ASSERT_TRUE(rpdo.begin(Fields{value(kFrequency, 4000)}));
  rpdo.forget(kTorque);
  rpdo.left();
  EXPECT_FALSE(rpdo.complete(Fields{value(kTorque, 0)}));
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 0)}));
  EXPECT_TRUE(rpdo.complete(Fields{value(kTorque, 0), value(kFrequency, 0)}));
  EXPECT_EQ(rpdo.repeated(), std::nullopt);
}

TEST(Rpdo, AFrameReliesOnWhatWasKnownWhereNotAllIsGivenWithIt) {
  Rpdo rpdo(veichi_rpdo1());
  const Fields all{value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)};
  ASSERT_TRUE(rpdo.begin(all));
  EXPECT_FALSE(rpdo.relies_on_known());
  rpdo.left();
  ASSERT_TRUE(rpdo.begin(Fields{value(kFrequency, 4000)}));
  EXPECT_TRUE(rpdo.relies_on_known());
  rpdo.left();
  ASSERT_TRUE(rpdo.begin(all));
  EXPECT_FALSE(rpdo.relies_on_known());
}

TEST(Rpdo, AnUnknownOutcomeUnknowsItsFieldsOnly) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 1)});
  const Fields stop{value(kControl, 5)};
  ASSERT_TRUE(rpdo.begin(stop));
  rpdo.outcome_unknown();
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
  EXPECT_TRUE(rpdo.complete(stop));
  // The drive may have stopped: repeating the frame before would start it again.
  EXPECT_EQ(rpdo.repeated(), std::nullopt);
}

TEST(Rpdo, AMomentaryValueIsForgottenAndNotRepeated) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, 0), value(kControl, 7)});
  rpdo.forget(kControl);
  EXPECT_FALSE(rpdo.complete(Fields{value(kFrequency, 4000)}));
  EXPECT_TRUE(rpdo.complete(Fields{value(kControl, 1)}));
  EXPECT_EQ(rpdo.repeated(), std::nullopt);
}

TEST(Rpdo, RepetitionDoesNotUndoAnSdoWrite) {
  Rpdo rpdo(veichi_rpdo1());
  send(rpdo, {value(kFrequency, 5000), value(kTorque, static_cast<Raw>(-1)), value(kControl, 1)});
  rpdo.note(value(kFrequency, 4000));
  EXPECT_EQ(bytes_of(rpdo.repeated().value()), (std::vector<std::uint8_t>{0x01, 0x00, 0xA0, 0x0F, 0xFF, 0xFF}));
}

TEST(Rpdo, UnusedFieldsAreZeroAndNotCommanded) {
  PdoSettings settings = veichi_rpdo1();
  settings.mapping[2].use = FieldUse::unused;
  Rpdo rpdo(settings);
  EXPECT_FALSE(rpdo.maps(kTorque));
  EXPECT_FALSE(rpdo.complete(Fields{value(kControl, 1), value(kFrequency, 5000), value(kTorque, 9)}));
  const auto frame = rpdo.begin(Fields{value(kControl, 1), value(kFrequency, 5000)});
  ASSERT_TRUE(frame);
  EXPECT_EQ(bytes_of(*frame), (std::vector<std::uint8_t>{0x01, 0x00, 0x88, 0x13, 0x00, 0x00}));
}

TEST(Rpdo, AnUnnamedFieldMakesItNeverComplete) {
  PdoSettings settings = veichi_rpdo1();
  settings.mapping[2].use = FieldUse::unnamed;
  Rpdo rpdo(settings);
  rpdo.note(value(kTorque, 0));
  EXPECT_FALSE(rpdo.complete(Fields{value(kControl, 1), value(kFrequency, 5000)}));
  EXPECT_EQ(rpdo.begin(Fields{value(kControl, 1), value(kFrequency, 5000), value(kTorque, 0)}), std::nullopt);
}

TEST(Rpdo, AForeignObjectIsNeverDroppedSilently) {
  Rpdo rpdo(veichi_rpdo1());
  EXPECT_FALSE(
      rpdo.complete(Fields{value(kControl, 1), value(kFrequency, 1), value(kTorque, 1), value({0x2030, 5}, 1)}));
}

TEST(Rpdo, AnEmptyMappingIsNeverSent) {
  Rpdo rpdo(PdoSettings{.cob_id = 0x205});
  EXPECT_EQ(rpdo.begin(Fields{}), std::nullopt);
}

}  // namespace
}  // namespace canopen
