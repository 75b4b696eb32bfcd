#include <gtest/gtest.h>

#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

constexpr std::uint8_t kOpte6Node = 4;

class Opte6Test : public ::testing::Test {
 protected:
  /// Maps 6040 + 6042 into RPDO1 and 6041 + 6044 into TPDO1 by the manual's procedure.
  void map_velocity() {
    for (const bool transmit : {false, true}) {
      const auto communication = static_cast<std::uint16_t>(transmit ? 0x1800 : 0x1400);
      const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
      const std::uint32_t cob_id = (transmit ? 0x180U : 0x200U) + kOpte6Node;
      ASSERT_EQ(bench.write(kOpte6Node, communication, 1, 0x80000000U | cob_id, 4), 0U);
      ASSERT_EQ(bench.write(kOpte6Node, mapping, 0, 0, 1), 0U);
      ASSERT_EQ(bench.write(kOpte6Node, mapping, 1, transmit ? 0x60410010 : 0x60400010, 4), 0U);
      ASSERT_EQ(bench.write(kOpte6Node, mapping, 2, transmit ? 0x60440010 : 0x60420010, 4), 0U);
      ASSERT_EQ(bench.write(kOpte6Node, mapping, 0, 2, 1), 0U);
      ASSERT_EQ(bench.write(kOpte6Node, communication, 1, cob_id, 4), 0U);
    }
  }
  void control(std::uint16_t word, std::int16_t rpm) {
    const auto target = static_cast<std::uint16_t>(rpm);
    bench.send(0x204, {static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8U),
                       static_cast<std::uint8_t>(target), static_cast<std::uint8_t>(target >> 8U)});
  }

  OneDrive bench{"vacon-opte6", kOpte6Node};
};

TEST_F(Opte6Test, HasThreePdoPairsAndNoDefaultMapping) {
  EXPECT_EQ(bench.read(kOpte6Node, 0x1402, 1), 0x404U);
  EXPECT_EQ(bench.read_abort(kOpte6Node, 0x1403, 1), 0x06020000U);
  EXPECT_EQ(bench.read_abort(kOpte6Node, 0x1A03, 0), 0x06020000U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x1A00, 0), 0U);
  bench.start();
  bench.advance(seconds(1));
  EXPECT_TRUE(bench.heard.empty());
}

TEST_F(Opte6Test, RunsInVelocityModeThroughItsPdos) {
  map_velocity();
  bench.start();
  EXPECT_EQ(word_at(*bench.last(0x184), 0) & 0x6FU, 0x40U);
  control(0x06, 750);
  EXPECT_EQ(word_at(*bench.last(0x184), 0) & 0x6FU, 0x21U);
  control(0x07, 750);
  EXPECT_EQ(word_at(*bench.last(0x184), 0) & 0x6FU, 0x23U);
  bench.advance(seconds(1));
  EXPECT_EQ(bench.drive().motor().output_hz(), 0.0);
  control(0x7F, 750);
  bench.advance(seconds(4));
  const auto tpdo = bench.last(0x184);
  EXPECT_EQ(word_at(*tpdo, 0) & 0x6FU, 0x27U);
  EXPECT_EQ(word_at(*tpdo, 0) & 0x600U, 0x600U);  // remote, target reached
  EXPECT_EQ(word_at(*tpdo, 2), 750U);
  control(0x7F, -300);
  bench.advance(seconds(5));
  EXPECT_EQ(static_cast<std::int16_t>(word_at(*bench.last(0x184), 2)), -300);
  EXPECT_EQ(bench.drive().record().rpdos[0], 4U);
}

TEST_F(Opte6Test, TheMappingProcedureIsEnforced) {
  EXPECT_EQ(bench.write(kOpte6Node, 0x1A00, 0, 0, 1), 0x06010000U);  // enabled
  ASSERT_EQ(bench.write(kOpte6Node, 0x1800, 1, 0x80000184U, 4), 0U);
  ASSERT_EQ(bench.write(kOpte6Node, 0x1A00, 1, 0x60410010, 4), 0U);
  ASSERT_EQ(bench.write(kOpte6Node, 0x1A00, 0, 1, 1), 0U);
  EXPECT_EQ(bench.write(kOpte6Node, 0x1A00, 1, 0x60440010, 4), 0x06010000U);  // sub 0 is not 0
  ASSERT_EQ(bench.write(kOpte6Node, 0x1A00, 0, 0, 1), 0U);
  EXPECT_EQ(bench.write(kOpte6Node, 0x1A00, 1, 0x60410020, 4), 0x06040041U);  // 16 bits
  EXPECT_EQ(bench.write(kOpte6Node, 0x1A00, 1, 0x21010010, 4), 0x06040041U);
  EXPECT_EQ(bench.write(kOpte6Node, 0x1A00, 1, 0x60430010, 4), 0x06020000U);
  for (std::uint8_t sub = 1; sub <= 5; ++sub) {
    ASSERT_EQ(bench.write(kOpte6Node, 0x1A00, sub, 0x60410010, 4), 0U);
  }
  EXPECT_EQ(bench.write(kOpte6Node, 0x1A00, 0, 5, 1), 0x06040042U);  // ten bytes
  EXPECT_EQ(bench.write(kOpte6Node, 0x1A00, 0, 4, 1), 0U);
  EXPECT_EQ(bench.write(kOpte6Node, 0x1800, 1, 0x184, 4), 0U);
  EXPECT_EQ(bench.write(kOpte6Node, 0x1800, 1, 0x185, 4), 0x06090030U);  // another COB-ID while enabled
  EXPECT_EQ(bench.write(kOpte6Node, 0x1800, 3, 100, 2), 0x08000022U);    // inhibit time while enabled
}

TEST_F(Opte6Test, PdosAreSetInPreOperationalOnly) {
  bench.start();
  EXPECT_EQ(bench.write(kOpte6Node, 0x1800, 1, 0x80000184U, 4), 0x08000022U);
  EXPECT_EQ(bench.write(kOpte6Node, 0x1800, 2, 1, 1), 0x08000022U);
  EXPECT_EQ(bench.write(kOpte6Node, 0x1400, 5, 100, 2), 0x08000022U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x1800, 1), 0x184U);
}

TEST_F(Opte6Test, SettingsOutliveResetCommunicationButNotAResetOfTheNode) {
  map_velocity();
  ASSERT_EQ(bench.write(kOpte6Node, 0x1017, 0, 100, 2), 0U);
  bench.nmt(0x82, kOpte6Node);
  EXPECT_EQ(bench.read(kOpte6Node, 0x1A00, 0), 2U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x1017, 0), 100U);
  bench.take(0x704);
  bench.advance(milliseconds(500));
  EXPECT_EQ(bench.take(0x704).size(), 5U);
  bench.nmt(0x81, kOpte6Node);
  EXPECT_EQ(bench.read(kOpte6Node, 0x1A00, 0), 0U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x1017, 0), 0U);
}

TEST_F(Opte6Test, ErrorResetSaysHowManyErrorsAreLeft) {
  map_velocity();
  ASSERT_EQ(bench.write(kOpte6Node, 0x1016, 1, 1U << 16U | 200U, 4), 0U);
  bench.start();
  bench.send(0x701, {5});
  bench.advance(milliseconds(200));
  EXPECT_EQ(bench.take(0x084), (std::vector{frame(0x084, {0x30, 0x81, 0x11, 1, 1, 0, 0, 0}),
                                            frame(0x084, {0x00, 0x10, 0x11, 53, 0, 0, 0, 0})}));
  EXPECT_EQ(bench.read(kOpte6Node, 0x2125, 0), 53U);
  bench.send(0x701, {5});
  EXPECT_EQ(bench.take(0x084), std::vector{frame(0x084, {0, 0, 0x01, 1, 0, 0, 0, 0})});  // not all clear
  ASSERT_EQ(bench.write(kOpte6Node, 0x6040, 0, 0x80, 2), 0U);
  EXPECT_EQ(bench.take(0x084), std::vector{frame(0x084, {0, 0, 0, 0, 0, 0, 0, 0})});
  EXPECT_EQ(bench.read(kOpte6Node, 0x1003, 0), 2U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x1003, 1), 0x1000U);
}

TEST_F(Opte6Test, ReceivingEndsIsADeadlineOnceItHasStarted) {
  ASSERT_EQ(bench.write(kOpte6Node, 0x1400, 5, 200, 2), 0U);
  map_velocity();
  bench.start();
  bench.advance(seconds(2));
  EXPECT_TRUE(bench.take(0x084).empty());
  for (int i = 0; i < 5; ++i) {
    control(0x06, 0);
    bench.advance(milliseconds(150));
  }
  EXPECT_TRUE(bench.take(0x084).empty());
  bench.advance(milliseconds(50));
  const auto emergencies = bench.take(0x084);
  ASSERT_EQ(emergencies.size(), 2U);
  EXPECT_EQ(word_at(emergencies[0], 0), 0x8250U);
  EXPECT_EQ(word_at(emergencies[1], 0), 0x1000U);
  EXPECT_EQ(*bench.read(kOpte6Node, 0x6041, 0) & 0x4FU, 0x08U);
}

TEST_F(Opte6Test, DriveValuesAreReadThroughTheirIds) {
  ASSERT_EQ(bench.write(kOpte6Node, 0x6042, 0, 600, 2), 0U);
  for (const std::uint32_t word : {0x06U, 0x07U, 0x0FU}) {
    ASSERT_EQ(bench.write(kOpte6Node, 0x6040, 0, word, 2), 0U);
  }
  bench.advance(seconds(4));
  EXPECT_EQ(bench.read(kOpte6Node, 0x2101, 0), 2000U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x2102, 0), 600U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x2107, 0), 308U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x2125, 0), 0U);
  ASSERT_EQ(bench.write(kOpte6Node, 0x2005, 0, 1, 1), 0U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x2101, 0), 200000U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x2102, 0), 6000000U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x2005, 0), 1U);
  EXPECT_EQ(bench.write(kOpte6Node, 0x2005, 0, 2, 1), 0x06090030U);
  EXPECT_EQ(bench.write(kOpte6Node, 0x2101, 0, 0, 2), 0x06010002U);
  EXPECT_EQ(bench.read_abort(kOpte6Node, 0x2108, 0), 0x06020000U);
  EXPECT_EQ(bench.read_abort(kOpte6Node, 0x603F, 0), 0x06020000U);
}

TEST_F(Opte6Test, IdentifiesAsAFrequencyConverter) {
  EXPECT_EQ(bench.read(kOpte6Node, 0x1000, 0), 0x00010192U);
  EXPECT_EQ(bench.read(kOpte6Node, 0x1018, 1), 0x90U);
}

TEST_F(Opte6Test, WarningsShowInTheStatuswordOnly) {
  bench.drive().warning(12);
  EXPECT_EQ(*bench.read(kOpte6Node, 0x6041, 0) & 0x80U, 0x80U);
  EXPECT_TRUE(bench.take(0x084).empty());
}

}  // namespace
}  // namespace simulator
