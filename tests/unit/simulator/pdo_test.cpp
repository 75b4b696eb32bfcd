// PDO rules of CiA 301 on the drive that follows them to the letter.
#include <gtest/gtest.h>

#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

constexpr std::uint8_t kMapped = 10;
constexpr std::uint32_t kTpdo = 0x18A;
constexpr std::uint32_t kRpdo = 0x20A;

class PdoTest : public ::testing::Test {
 protected:
  PdoTest() { EXPECT_EQ(bench.write(kMapped, 0x1801, 1, 0x8000028AU, 4), 0U); }

  void set_tpdo(std::uint8_t type, std::uint16_t inhibit = 0, std::uint16_t event = 0, std::uint8_t start = 0) {
    ASSERT_EQ(bench.write(kMapped, 0x1800, 1, 0x80000000U | kTpdo, 4), 0U);
    ASSERT_EQ(bench.write(kMapped, 0x1800, 2, type, 1), 0U);
    ASSERT_EQ(bench.write(kMapped, 0x1800, 3, inhibit, 2), 0U);
    ASSERT_EQ(bench.write(kMapped, 0x1800, 5, event, 2), 0U);
    ASSERT_EQ(bench.write(kMapped, 0x1800, 6, start, 1), 0U);
    ASSERT_EQ(bench.write(kMapped, 0x1800, 1, kTpdo, 4), 0U);
  }
  void change() {
    warning_ = !warning_;
    warning_ ? bench.drive().warning(1) : bench.drive().clear_faults();
  }

  OneDrive bench{"cia402-velocity", kMapped};

 private:
  bool warning_ = false;
};

TEST_F(PdoTest, OnChangeWithinATick) {
  set_tpdo(255);
  bench.start();
  EXPECT_EQ(bench.take(kTpdo).size(), 1U);  // first value
  bench.advance(seconds(1));
  EXPECT_TRUE(bench.take(kTpdo).empty());
  change();
  bench.advance(Network::kTick);
  EXPECT_EQ(bench.take(kTpdo).size(), 1U);
}

TEST_F(PdoTest, InhibitTimeIsInHundredMicroseconds) {
  set_tpdo(254, 1000);
  bench.start();
  bench.take(kTpdo);
  change();
  bench.advance(milliseconds(99));
  EXPECT_TRUE(bench.take(kTpdo).empty());
  bench.advance(milliseconds(1));
  EXPECT_EQ(bench.take(kTpdo).size(), 1U);
  for (int i = 0; i < 100; ++i) {
    change();
    bench.advance(milliseconds(10));
  }
  const auto count = bench.take(kTpdo).size();
  EXPECT_GE(count, 9U);
  EXPECT_LE(count, 10U);
}

TEST_F(PdoTest, EventTimerSendsWithoutChange) {
  set_tpdo(255, 0, 250);
  bench.start();
  bench.take(kTpdo);
  bench.advance(milliseconds(249));
  EXPECT_TRUE(bench.take(kTpdo).empty());
  bench.advance(milliseconds(1));
  EXPECT_EQ(bench.take(kTpdo).size(), 1U);
  bench.advance(seconds(1));
  EXPECT_EQ(bench.take(kTpdo).size(), 4U);
}

TEST_F(PdoTest, TypeZeroWaitsForChangeAndSync) {
  set_tpdo(0);
  bench.start();
  bench.send(0x80, {});
  EXPECT_EQ(bench.take(kTpdo).size(), 1U);
  bench.send(0x80, {});
  EXPECT_TRUE(bench.take(kTpdo).empty());
  change();
  bench.advance(milliseconds(50));
  EXPECT_TRUE(bench.take(kTpdo).empty());
  bench.send(0x80, {});
  EXPECT_EQ(bench.take(kTpdo).size(), 1U);
}

TEST_F(PdoTest, SyncStartValueNamesTheFirstSync) {
  ASSERT_EQ(bench.write(kMapped, 0x1019, 0, 10, 1), 0U);
  set_tpdo(2, 0, 0, 3);
  bench.start();
  std::vector<std::uint8_t> sent_at;
  for (std::uint8_t counter = 1; counter <= 8; ++counter) {
    bench.send(0x80, {counter});
    if (!bench.take(kTpdo).empty()) {
      sent_at.push_back(counter);
    }
  }
  EXPECT_EQ(sent_at, (std::vector<std::uint8_t>{3, 5, 7}));
}

TEST_F(PdoTest, ASyncOfAWrongLengthIsReportedOnce) {
  set_tpdo(1);
  bench.start();
  bench.send(0x80, {1});
  bench.send(0x80, {2});
  EXPECT_TRUE(bench.take(kTpdo).empty());
  const auto emergencies = bench.take(0x08A);
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(word_at(emergencies[0], 0), 0x8240U);
  bench.send(0x80, {});
  EXPECT_EQ(bench.take(kTpdo).size(), 1U);
  EXPECT_EQ(bench.take(0x08A).size(), 1U);  // error reset
}

TEST_F(PdoTest, RemoteRequestsAreForTypes252And253) {
  set_tpdo(253);
  bench.start();
  bench.remote_request(kTpdo);
  EXPECT_EQ(bench.take(kTpdo).size(), 1U);
  bench.nmt(0x80, kMapped);
  set_tpdo(252);
  bench.start();
  bench.send(0x80, {});
  const auto before = word_at(
      *[&] {
        bench.remote_request(kTpdo);
        return bench.last(kTpdo);
      }(),
      0);
  change();
  bench.remote_request(kTpdo);
  EXPECT_EQ(word_at(*bench.last(kTpdo), 0), before);  // sampled at the last SYNC
  bench.send(0x80, {});
  bench.remote_request(kTpdo);
  EXPECT_NE(word_at(*bench.last(kTpdo), 0), before);
  bench.nmt(0x80, kMapped);
  set_tpdo(255);
  bench.start();
  bench.take(kTpdo);
  bench.remote_request(kTpdo);
  EXPECT_TRUE(bench.take(kTpdo).empty());
}

TEST_F(PdoTest, SynchronousRpdosTakeEffectAtTheSync) {
  ASSERT_EQ(bench.write(kMapped, 0x1400, 2, 1, 1), 0U);
  bench.start();
  bench.send(kRpdo, {0x06, 0x00});
  EXPECT_EQ(*bench.read(kMapped, 0x6041, 0) & 0x6FU, 0x40U);
  bench.send(0x80, {});
  EXPECT_EQ(*bench.read(kMapped, 0x6041, 0) & 0x6FU, 0x21U);
}

TEST_F(PdoTest, RpdosOfAWrongLength) {
  bench.start();
  bench.send(kRpdo, {0x06});
  EXPECT_EQ(word_at(*bench.last(0x08A), 0), 0x8210U);
  EXPECT_EQ(*bench.read(kMapped, 0x6041, 0) & 0x6FU, 0x40U);
  bench.send(kRpdo, {0x06, 0x00, 0x00});
  EXPECT_EQ(word_at(*bench.last(0x08A), 0), 0x8220U);
  EXPECT_EQ(*bench.read(kMapped, 0x6041, 0) & 0x6FU, 0x21U);
  bench.send(kRpdo, {0x06, 0x00});
  EXPECT_EQ(word_at(*bench.last(0x08A), 0), 0x0000U);
  EXPECT_EQ(bench.drive().record().rpdo_length_errors, 2U);
}

TEST_F(PdoTest, ADisabledPdoIsSilentAndDeaf) {
  ASSERT_EQ(bench.write(kMapped, 0x1800, 1, 0x80000000U | kTpdo, 4), 0U);
  ASSERT_EQ(bench.write(kMapped, 0x1400, 1, 0x80000000U | kRpdo, 4), 0U);
  bench.start();
  bench.send(kRpdo, {0x06, 0x00});
  bench.advance(seconds(1));
  EXPECT_TRUE(bench.take(kTpdo).empty());
  EXPECT_EQ(bench.drive().record().rpdo_total(), 0U);
}

TEST_F(PdoTest, CobIdsAndTypesAreChecked) {
  EXPECT_EQ(bench.write(kMapped, 0x1801, 1, 0x601, 4), 0x06090030U);       // restricted
  EXPECT_EQ(bench.write(kMapped, 0x1801, 1, 0x2000028A, 4), 0x06090030U);  // 29 bits
  EXPECT_EQ(bench.write(kMapped, 0x1801, 1, 0x3AA, 4), 0U);
  EXPECT_EQ(bench.write(kMapped, 0x1800, 2, 241, 1), 0x06090030U);
  EXPECT_EQ(bench.write(kMapped, 0x1400, 2, 252, 1), 0x06090030U);
  EXPECT_EQ(bench.read_abort(kMapped, 0x1800, 4), 0x06090011U);
  EXPECT_EQ(bench.read(kMapped, 0x1800, 0), 6U);
  EXPECT_EQ(bench.read(kMapped, 0x1400, 0), 5U);
}

TEST_F(PdoTest, NothingIsSentAfterOperational) {
  set_tpdo(255, 0, 100);
  bench.start();
  bench.nmt(0x02, kMapped);
  bench.heard.clear();
  change();
  bench.advance(seconds(2));
  EXPECT_TRUE(bench.heard.empty());
}

TEST(CommissionedTpdos, EventTimerAtPowerOnIsTheOneThatWasSet) {
  DriveOptions options;
  options.tpdo_event_ms = 500;
  OneDrive bench{"cia402-velocity", kMapped, options};
  EXPECT_EQ(bench.read(kMapped, 0x1800, 5), 500U);
  EXPECT_EQ(bench.write(kMapped, 0x1800, 5, 100, 2), 0U);
  bench.drive().reboot();
  bench.advance(seconds(1));
  EXPECT_EQ(bench.read(kMapped, 0x1800, 5), 500U);
  bench.start();
  bench.take(kTpdo);
  bench.advance(seconds(5));
  EXPECT_EQ(bench.take(kTpdo).size(), 10U);
}

TEST(CommissionedTpdos, OnesWithoutObjectsFollowToo) {
  DriveOptions options;
  options.tpdo_event_ms = 500;
  OneDrive bench{"veichi-ac310", kMapped, options};
  bench.start();
  bench.take(0x28A);
  bench.advance(seconds(5));
  EXPECT_EQ(bench.take(0x28A).size(), 10U);
}

TEST(CommissionedTpdos, OneThatKnowsNoEventTimerStaysAsItIs) {
  DriveOptions options;
  options.tpdo_event_ms = 500;
  OneDrive bench{"invt-goodrive600", kMapped, options};
  EXPECT_EQ(bench.read(kMapped, 0x1800, 5), 0U);
  EXPECT_EQ(bench.read(kMapped, 0x1801, 5), 500U);
}

}  // namespace
}  // namespace simulator
