// Setting up PDOs in the course of a boot: what is written, in which order, and what is taken for granted.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "canopen/communication_objects.h"
#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using Bytes = support::ScriptedSlave::Bytes;

class PdoSetupTest : public NodeBench {};

TEST_F(PdoSetupTest, MappingIsWrittenInTheOrderOfTheStandard) {
  install(bench_settings());
  slave_.set({0x1A00, 2}, DataType::u32, 0x60430010);
  boot(bench_settings());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(slave_.writes(),
            (std::vector<ObjectAddress>{{0x1800, 1}, {0x1A00, 0}, {0x1A00, 1}, {0x1A00, 2}, {0x1A00, 0}, {0x1800, 1}}));
  EXPECT_EQ(slave_.value({0x1A00, 2}), 0x60440010U);
  EXPECT_EQ(slave_.value({0x1800, 1}), 0x40000185U) << "bit 30 is the drive's own";
  EXPECT_TRUE(node_->tpdo_verified(1));
}

TEST_F(PdoSetupTest, OnlyDifferingParametersAreWrittenWhileThePdoIsInvalid) {
  install(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  std::vector<std::uint64_t> valid;
  slave_.on_write([&](ObjectAddress object) {
    if (object == ObjectAddress{0x1800, 5}) {
      valid.push_back(slave_.value({0x1800, 1}) >> 31U);
    }
  });
  boot(bench_settings());
  EXPECT_TRUE(status().online);
  EXPECT_EQ(slave_.writes(), (std::vector<ObjectAddress>{{0x1800, 1}, {0x1800, 5}, {0x1800, 1}}));
  EXPECT_EQ(valid, std::vector<std::uint64_t>{1});
  EXPECT_TRUE(node_->tpdo_verified(1));
}

TEST_F(PdoSetupTest, EachObjectIsReadOnceAndReadBackOnlyWhereItWasWritten) {
  install(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  boot(bench_settings());
  EXPECT_TRUE(status().online);
  const std::vector<ObjectAddress> compared{{0x1800, 1}, {0x1800, 2}, {0x1800, 5},
                                            {0x1A00, 0}, {0x1A00, 1}, {0x1A00, 2}};
  const std::vector<ObjectAddress> read_back{{0x1800, 1}, {0x1800, 5}};
  const std::vector<ObjectAddress> rpdo{{0x1400, 1}, {0x1400, 2}, {0x1600, 0}, {0x1600, 1}, {0x1600, 2}};
  std::vector<ObjectAddress> wanted{kHeartbeatTime};
  for (const auto& part : {compared, read_back, rpdo}) {
    wanted.insert(wanted.end(), part.begin(), part.end());
  }
  wanted.push_back(kEmcyCobId);
  EXPECT_EQ(slave_.reads(), wanted);
}

TEST_F(PdoSetupTest, AMappingThatTheDriveClearsWhenItIsSwitchedOffIsSetUpToo) {
  install(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  slave_.on_write([&](ObjectAddress object) {
    if (object == ObjectAddress{0x1800, 1} && (slave_.value(object) >> 31U) != 0) {
      slave_.set({0x1A00, 2}, DataType::u32, 0);
    }
  });
  boot(bench_settings());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(slave_.value({0x1A00, 2}), 0x60440010U);
  EXPECT_EQ(slave_.value({0x1800, 1}), 0x40000185U);
}

TEST_F(PdoSetupTest, AVerifiedMappingThatTheDriveClearsItselfIsNoticed) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].mapping_policy = SetupPolicy::verify;
  install(settings);
  slave_.set({0x1800, 5}, DataType::u16, 0);
  slave_.on_write([&](ObjectAddress object) {
    if (object == ObjectAddress{0x1800, 1} && (slave_.value(object) >> 31U) != 0) {
      slave_.set({0x1A00, 0}, DataType::u8, 0);
    }
  });
  boot(settings);
  expect_letter(BootResult::not_configured,
                "0x1A00:00 TPDO1 number of mapped objects: expected 2, found 0 after it was written");
}

TEST_F(PdoSetupTest, InvalidPdoWithAnotherCobIdIsCorrected) {
  install(bench_settings());
  slave_.set({0x1400, 1}, DataType::u32, 0x80000305);
  boot(bench_settings());
  EXPECT_TRUE(status().online);
  EXPECT_EQ(slave_.writes(), (std::vector<ObjectAddress>{{0x1400, 1}}));
  EXPECT_EQ(slave_.value({0x1400, 1}), 0x205U);
}

TEST_F(PdoSetupTest, SubZeroThatTheDriveClearsItselfIsNoFailure) {
  install(bench_settings());
  slave_.set({0x1A00, 1}, DataType::u32, 0);
  slave_.on_write([&](ObjectAddress object) {
    if (object == ObjectAddress{0x1800, 1} && (slave_.value(object) >> 31U) != 0) {
      slave_.set({0x1A00, 0}, DataType::u8, 0);
    }
  });
  boot(bench_settings());
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(slave_.value({0x1A00, 0}), 2U);
}

TEST_F(PdoSetupTest, AbsentPdoObjectsMeanTheDocumentedDefault) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].mapping_policy = SetupPolicy::verify;
  install(settings);
  for (std::uint8_t sub = 0; sub <= 5; ++sub) {
    slave_.remove({0x1800, sub});
    slave_.remove({0x1A00, sub});
  }
  boot(settings);
  EXPECT_TRUE(status().online);
  EXPECT_FALSE(node_->tpdo_verified(1));
  ASSERT_EQ(events_.remarks.size(), 1U);
  EXPECT_NE(events_.remarks[0].find("TPDO1"), std::string::npos);
  EXPECT_TRUE(slave_.writes().empty());
}

// A layout is written where no default is known. Without the object the drive may send and take anything else.
TEST_F(PdoSetupTest, ALayoutThatIsToBeWrittenIsNeverTakenForGranted) {
  install(bench_settings());
  slave_.remove({0x1A00, 0});
  boot(bench_settings());
  expect_letter(BootResult::not_configured, "mapping: the drive does not have it, so what this PDO holds is not known");
}

TEST_F(PdoSetupTest, NorIsThatOfAnRpdo) {
  install(bench_settings());
  slave_.remove({0x1600, 0});
  boot(bench_settings());
  expect_letter(BootResult::not_configured, "0x1600:00 RPDO1 mapping: the drive does not have it");
}

TEST_F(PdoSetupTest, NorIsItWithoutTheWholePdo) {
  install(bench_settings());
  for (std::uint8_t sub = 0; sub <= 5; ++sub) {
    slave_.remove({0x1800, sub});
    slave_.remove({0x1A00, sub});
  }
  boot(bench_settings());
  expect_letter(BootResult::not_configured, "0x1A00:00 TPDO1 mapping: the drive does not have it");
}

TEST_F(PdoSetupTest, AbsentMappingLeavesTheRestWritten) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].mapping_policy = SetupPolicy::verify;
  install(settings);
  slave_.remove({0x1A00, 0});
  slave_.set({0x1800, 2}, DataType::u8, 1);
  boot(settings);
  EXPECT_TRUE(status().online);
  EXPECT_TRUE(node_->tpdo_verified(1));
  EXPECT_EQ(slave_.value({0x1800, 2}), 255U);
}

TEST_F(PdoSetupTest, AbsentEventTimerLeavesTheTimingUnverified) {
  install(bench_settings());
  slave_.remove({0x1800, 5});
  boot(bench_settings());
  EXPECT_TRUE(status().online);
  EXPECT_FALSE(node_->tpdo_verified(1));
}

TEST_F(PdoSetupTest, VerifyNeverWrites) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].mapping_policy = SetupPolicy::verify;
  install(settings);
  slave_.set({0x1A00, 0}, DataType::u8, 1);
  slave_.set({0x1800, 5}, DataType::u16, 0);
  boot(settings);
  expect_letter(BootResult::not_configured, "TPDO1 event timer: expected 100, found 0");
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(PdoSetupTest, AssumeNeitherReadsNorWrites) {
  NodeSettings settings = bench_settings();
  settings.error_control.policy = SetupPolicy::assume;
  for (PdoSettings* pdo : {&settings.tpdos[0], &settings.rpdos[0]}) {
    pdo->communication = SetupPolicy::assume;
    pdo->mapping_policy = SetupPolicy::assume;
  }
  slave_.set(kHeartbeatTime, DataType::u16, 500);
  boot(settings);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(slave_.reads(), std::vector<ObjectAddress>{kEmcyCobId});
  EXPECT_TRUE(slave_.writes().empty());
  EXPECT_FALSE(node_->tpdo_verified(1));
}

TEST_F(PdoSetupTest, MappingAloneKeepsTheCobIdAsItWas) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].communication = SetupPolicy::assume;
  install(settings);
  slave_.set({0x1800, 1}, DataType::u32, 0x40000285);
  slave_.set({0x1A00, 0}, DataType::u8, 1);
  boot(settings);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(slave_.value({0x1800, 1}), 0x40000285U);
  EXPECT_EQ(slave_.value({0x1A00, 0}), 2U);
}

TEST_F(PdoSetupTest, MappingAloneEnablesWhatAnInterruptedSetUpLeftDisabled) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].communication = SetupPolicy::assume;
  install(settings);
  slave_.set({0x1800, 1}, DataType::u32, 0xC0000185);
  slave_.set({0x1A00, 0}, DataType::u8, 0);
  boot(settings);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(slave_.value({0x1800, 1}), 0x40000185U);
  EXPECT_EQ(slave_.value({0x1A00, 0}), 2U);
}

TEST_F(PdoSetupTest, MappingAloneEnablesAlsoWhereOnlyTheLastStepWasMissing) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].communication = SetupPolicy::assume;
  install(settings);
  slave_.set({0x1800, 1}, DataType::u32, 0xC0000185);
  boot(settings);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(slave_.value({0x1800, 1}), 0x40000185U);
  EXPECT_EQ(slave_.writes(), (std::vector<ObjectAddress>{{0x1800, 1}}));
}

TEST_F(PdoSetupTest, VerifiedCommunicationIsEnabledWhereASetUpOfTheMappingLeftItDisabled) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].communication = SetupPolicy::verify;
  install(settings);
  slave_.set({0x1800, 1}, DataType::u32, 0xC0000185);
  slave_.set({0x1A00, 0}, DataType::u8, 0);
  boot(settings);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(slave_.value({0x1800, 1}), 0x40000185U);
  EXPECT_EQ(slave_.value({0x1A00, 0}), 2U);
}

TEST_F(PdoSetupTest, WhatIsVerifiedOnlyStaysDisabled) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].communication = SetupPolicy::verify;
  settings.tpdos[0].mapping_policy = SetupPolicy::verify;
  install(settings);
  slave_.set({0x1800, 1}, DataType::u32, 0xC0000185);
  boot(settings);
  expect_letter(BootResult::not_configured, "TPDO1 COB-ID: expected 0x185, found 0xC0000185");
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(PdoSetupTest, ARefusedParameterLeavesThePdoAsItWas) {
  install(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  slave_.refuse_write({0x1800, 5}, 0x06090030);
  boot(bench_settings());
  expect_letter(BootResult::not_configured, "writing TPDO1 event timer = 0x64");
  EXPECT_EQ(status().boot_text.find("switched off"), std::string::npos) << status().boot_text;
  EXPECT_EQ(slave_.value({0x1800, 1}), 0x40000185U);
  EXPECT_EQ(slave_.writes(), (std::vector<ObjectAddress>{{0x1800, 1}, {0x1800, 5}, {0x1800, 1}}));
}

TEST_F(PdoSetupTest, AMappingThatCannotBeReadLeavesThePdoAsItWas) {
  install(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  slave_.remove({0x1A00, 2});
  boot(bench_settings());
  expect_letter(BootResult::not_configured, "TPDO1 mapping: refused");
  EXPECT_EQ(status().boot_text.find("switched off"), std::string::npos) << status().boot_text;
  EXPECT_EQ(slave_.value({0x1800, 1}), 0x40000185U);
}

TEST_F(PdoSetupTest, ARefusedMappingSaysThatThePdoIsLeftSwitchedOff) {
  install(bench_settings());
  slave_.set({0x1A00, 2}, DataType::u32, 0x60430010);
  slave_.refuse_write({0x1A00, 2}, 0x06040041);
  boot(bench_settings());
  expect_letter(BootResult::not_configured, "writing TPDO1 mapping = 0x60440010");
  expect_letter(BootResult::not_configured, "; TPDO1 is left switched off");
  EXPECT_EQ(slave_.value({0x1800, 1}), 0xC0000185U);
}

TEST_F(PdoSetupTest, APdoThatCannotBeSwitchedOffIsNotSaidToBe) {
  install(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  slave_.refuse_write({0x1800, 1}, 0x06010002);
  boot(bench_settings());
  expect_letter(BootResult::not_configured, "writing TPDO1 COB-ID = 0xC0000185");
  EXPECT_EQ(status().boot_text.find("switched off"), std::string::npos) << status().boot_text;
  EXPECT_EQ(slave_.writes(), (std::vector<ObjectAddress>{{0x1800, 1}}));
}

}  // namespace
}  // namespace canopen
