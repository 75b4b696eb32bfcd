// Block transfer of the SDO client over time, against a server that was written from the standard alone.

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/unit/canopen/sdo_fault_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::BlockServer;
using support::block::Place;
using Bytes = SdoFaultBench::Bytes;

constexpr ObjectAddress kFile = SdoFaultBench::kFile;
constexpr ObjectAddress kOther = SdoFaultBench::kOther;

SdoSettings by_block() {
  SdoSettings settings;
  settings.block = true;
  return settings;
}

/// How a transfer ends.
struct Ending {
  const char* what;
  std::function<void(BlockServer&)> arrange;
  std::optional<ErrorKind> error{};  ///< Nothing: it is well.
  std::size_t begun = 1;             ///< Times a block transfer was asked for.
};

TEST(SdoBlockClient, TakesDataOfAnyLength) {
  for (const std::size_t size : {1U, 4U, 5U, 28U, 29U, 217U, 218U, 889U, 890U, 5000U, 65535U}) {
    SCOPED_TRACE(size);
    SdoFaultBench bench(by_block());
    const Bytes data = SdoFaultBench::counted(size);
    bench.node.server.objects[kFile] = data;
    const auto reading = bench.read(kFile);
    ASSERT_TRUE(bench.loop.advance_until([&] { return reading.done(); }, 20s));
    ASSERT_TRUE(reading.get().has_value()) << to_string(reading.get().error());
    EXPECT_EQ(reading.get().value(), data);
    bench.node.server.objects[kFile] = {0};
    const auto writing = bench.command(kFile, data, 60s);
    ASSERT_TRUE(bench.loop.advance_until([&] { return writing.done(); }, 60s));
    ASSERT_TRUE(writing.get().has_value()) << to_string(writing.get().error());
    EXPECT_EQ(bench.node.server.objects[kFile], data);
    EXPECT_EQ(bench.begun_with(0xC6), size > 28 ? 1U : 0U);
    EXPECT_TRUE(bench.node.server.idle());
  }
}

TEST(SdoBlockClient, MoreThanIsTakenIsRefusedEarly) {
  SdoFaultBench bench(by_block());
  bench.node.server.objects[kFile] = SdoFaultBench::counted(65536);
  const auto reading = bench.read(kFile);
  ASSERT_TRUE(bench.loop.advance_until([&] { return reading.done(); }, 5s));
  EXPECT_EQ(reading.get().error().kind, ErrorKind::protocol);
  bench.loop.advance(1ms);
  ASSERT_EQ(bench.node.server.aborts_heard().size(), 1U);
  EXPECT_EQ(bench.node.server.aborts_heard()[0].code, 0x05040005U);
}

TEST(SdoBlockClient, UploadsWhateverTheServerDoes) {
  const std::vector<Ending> endings{
      {"the first segment is lost", [](BlockServer& server) { server.faults.lose = Place{1, 1}; }},
      {"one in the middle", [](BlockServer& server) { server.faults.lose = Place{1, 17}; }},
      {"the last of a sub-block", [](BlockServer& server) { server.faults.lose = Place{2, 31}; }, {}, 2},
      {"the last of all", [](BlockServer& server) { server.faults.lose = Place{3, 3}; }, {}, 2},
      {"the first of the last sub-block", [](BlockServer& server) { server.faults.lose = Place{3, 1}; }},
      {"one comes twice", [](BlockServer& server) { server.faults.send_twice = Place{1, 5}; }},
      {"the last of a sub-block comes twice", [](BlockServer& server) { server.faults.send_twice = Place{1, 31}; }},
      {"the last of all comes twice", [](BlockServer& server) { server.faults.send_twice = Place{3, 3}; }},
      {"an abort that names another object",
       [](BlockServer& server) { server.faults.foreign_abort = {3, {{0x2030, 7}, 0x06020000}}; }},
      {"no check sum", [](BlockServer& server) { server.faults.crc_supported = false; }},
      {"no size", [](BlockServer& server) { server.faults.size_indicated = false; }},
      {"a size of 0", [](BlockServer& server) { server.faults.indicated_size = 0; }},
      {"a size too large", [](BlockServer& server) { server.faults.indicated_size = 60'000; }},
      {"a size too small", [](BlockServer& server) { server.faults.indicated_size = 7; }},
      {"a wrong check sum", [](BlockServer& server) { server.faults.wrong_crc = true; }, ErrorKind::protocol},
      {"a wrong number of bytes", [](BlockServer& server) { server.faults.wrong_n = 0; }, ErrorKind::protocol},
      {"an abort at once", [](BlockServer& server) { server.faults.abort = {0, 0x08000022}; }, ErrorKind::refused},
      {"an abort on the way", [](BlockServer& server) { server.faults.abort = {5, 0x08000022}; }, ErrorKind::refused},
      {"silence from the beginning", [](BlockServer& server) { server.faults.frames_until_silence = 0; },
       ErrorKind::timeout},
      {"silence on the way", [](BlockServer& server) { server.faults.frames_until_silence = 40; }, ErrorKind::timeout,
       2},
  };
  for (const Ending& each : endings) {
    SCOPED_TRACE(each.what);
    SdoFaultBench bench(by_block());
    const Bytes data = SdoFaultBench::counted(65 * 7 - 3);
    bench.node.server.objects[kFile] = data;
    each.arrange(bench.node.server);
    const auto reading = bench.read(kFile);
    ASSERT_TRUE(bench.loop.advance_until([&] { return reading.done(); }, 20s));
    ASSERT_EQ(reading.get().has_error(), each.error.has_value());
    if (each.error) {
      EXPECT_EQ(reading.get().error().kind, *each.error) << to_string(reading.get().error());
    } else {
      EXPECT_EQ(reading.get().value(), data);
    }
    EXPECT_EQ(bench.begun_with(0xA4), each.begun) << "what has an end is not begun again";
    bench.loop.advance(1ms);
    EXPECT_TRUE(bench.node.server.idle() || bench.node.server.faults.frames_until_silence);
  }
}

TEST(SdoBlockClient, DownloadsWhateverTheServerDoes) {
  const std::vector<Ending> endings{
      {"the first segment is lost", [](BlockServer& server) { server.faults.lose = Place{1, 1}; }},
      {"one in the middle", [](BlockServer& server) { server.faults.lose = Place{2, 9}; }},
      {"the same, told at once",
       [](BlockServer& server) {
         server.faults.lose = Place{2, 9};
         server.faults.acknowledge_at_gap = true;
       }},
      {"the first of a sub-block, told at once",
       [](BlockServer& server) {
         server.faults.lose = Place{2, 1};
         server.faults.acknowledge_at_gap = true;
       }},
      {"nothing of a sub-block is acknowledged", [](BlockServer& server) { server.faults.acknowledge = 0; }},
      {"half of one", [](BlockServer& server) { server.faults.acknowledge = 10; }},
      {"sub-blocks of one segment", [](BlockServer& server) { server.faults.block_sizes = {1}; }},
      {"sub-blocks of changing size", [](BlockServer& server) { server.faults.block_sizes = {5, 127, 1, 20}; }},
      {"no check sum", [](BlockServer& server) { server.faults.crc_supported = false; }},
      {"a wrong check sum", [](BlockServer& server) { server.faults.wrong_crc = true; }, ErrorKind::refused},
      {"an acknowledgement of what was not sent", [](BlockServer& server) { server.faults.acknowledge = 90; },
       ErrorKind::protocol},
      {"sub-blocks of no size", [](BlockServer& server) { server.faults.block_sizes = {20, 0}; }, ErrorKind::protocol},
      {"sub-blocks of 128", [](BlockServer& server) { server.faults.block_sizes = {128}; }, ErrorKind::protocol},
      {"an abort on the way", [](BlockServer& server) { server.faults.abort_on = Place{2, 3}; }, ErrorKind::refused},
      {"an abort of the end", [](BlockServer& server) { server.faults.abort = {5, 0x08000022}; }, ErrorKind::refused},
      {"the last segment of a sub-block is lost", [](BlockServer& server) { server.faults.lose = Place{2, 20}; },
       ErrorKind::timeout},
      {"silence on the way", [](BlockServer& server) { server.faults.frames_until_silence = 2; }, ErrorKind::timeout},
  };
  for (const Ending& each : endings) {
    SCOPED_TRACE(each.what);
    SdoFaultBench bench(by_block());
    const Bytes data = SdoFaultBench::counted(65 * 7 - 3);
    const Bytes before{1};
    bench.node.server.objects[kFile] = before;
    bench.node.server.faults.block_sizes = {20};
    each.arrange(bench.node.server);
    const auto writing = bench.command(kFile, data);
    ASSERT_TRUE(bench.loop.advance_until([&] { return writing.done(); }, 1s));
    ASSERT_EQ(writing.get().has_error(), each.error.has_value());
    if (each.error) {
      EXPECT_EQ(writing.get().error().kind, *each.error) << to_string(writing.get().error());
      EXPECT_EQ(writing.get().error().outcome_unknown, each.error != ErrorKind::refused);
      EXPECT_EQ(bench.node.server.objects[kFile], before);
    } else {
      EXPECT_EQ(bench.node.server.objects[kFile], data);
    }
    EXPECT_EQ(bench.begun_with(0xC6), 1U);
    bench.loop.advance(1ms);
    EXPECT_TRUE(bench.node.server.idle());
  }
}

TEST(SdoBlockClient, AServerThatKnowsNoBlockTransferIsAskedOnce) {
  SdoFaultBench bench(by_block());
  const Bytes data = SdoFaultBench::counted(100);
  bench.node.server.objects[kFile] = data;
  bench.node.server.faults.refuse_block = true;
  for (int read = 0; read < 3; ++read) {
    const auto reading = bench.read(kFile);
    ASSERT_TRUE(bench.loop.advance_until([&] { return reading.done(); }, 5s));
    EXPECT_EQ(reading.get().value(), data);
  }
  const auto writing = bench.command(kFile, data);
  ASSERT_TRUE(bench.loop.advance_until([&] { return writing.done(); }, 1s));
  EXPECT_TRUE(writing.get().has_value());
  EXPECT_EQ(bench.begun_with(0xA4) + bench.begun_with(0xC6), 1U);
  EXPECT_EQ(bench.remarks.size(), 1U);
  bench.client->interrupt();  // It may have got another firmware.
  bench.loop.advance(1ms);
  const auto reading = bench.read(kFile);
  ASSERT_TRUE(bench.loop.advance_until([&] { return reading.done(); }, 5s));
  EXPECT_EQ(bench.begun_with(0xA4), 2U);
}

// 4 000 bytes take more than a second; a command is not begun where less time is left than a write takes.
TEST(SdoBlockClient, LongWritesSayNothingOfTheTimeThatShortOnesTake) {
  for (const bool block : {true, false}) {
    SdoFaultBench bench(block ? by_block() : SdoSettings(), 125'000);
    bench.node.server.objects[kFile] = {0};
    const auto shortly = bench.command(kOther, {9, 0});
    bench.loop.advance(50ms);
    ASSERT_TRUE(shortly.done());
    const Duration usual = bench.client->write_time();
    EXPECT_LT(usual, 10ms);
    const auto writing = bench.command(kFile, SdoFaultBench::counted(4000), 5s);
    ASSERT_TRUE(bench.loop.advance_until([&] { return writing.done(); }, 5s));
    ASSERT_TRUE(writing.get().has_value()) << to_string(writing.get().error());
    EXPECT_EQ(bench.client->write_time(), usual);
  }
}

TEST(SdoBlockClient, SmallDataMayComeTheUsualWay) {
  for (const auto choice : {support::block::ProtocolSwitch::where_allowed, support::block::ProtocolSwitch::always}) {
    SdoFaultBench bench(by_block());
    const Bytes data = SdoFaultBench::counted(20);
    bench.node.server.objects[kFile] = data;
    bench.node.server.faults.protocol_switch = choice;
    const auto reading = bench.read(kFile);
    ASSERT_TRUE(bench.loop.advance_until([&] { return reading.done(); }, 5s));
    EXPECT_EQ(reading.get().value(), data);
    EXPECT_EQ(bench.begun_with(0xA3), 0U);
  }
}

TEST(SdoBlockClient, WithoutTheKeyNothingGoesByBlock) {
  SdoFaultBench bench;
  bench.node.server.objects[kFile] = SdoFaultBench::counted(1000);
  const auto reading = bench.read(kFile);
  ASSERT_TRUE(bench.loop.advance_until([&] { return reading.done(); }, 5s));
  EXPECT_EQ(reading.get().value().size(), 1000U);
  EXPECT_EQ(bench.begun_with(0xA4), 0U);
}

// 125 kbit/s: a frame takes one millisecond.
TEST(SdoBlockClient, ACommandEndsABlockUploadWhichIsBegunAnew) {
  SdoFaultBench bench(by_block(), 125'000);
  const Bytes data = SdoFaultBench::counted(2000);
  bench.node.server.objects[kFile] = data;
  const auto reading = bench.read(kFile);
  bench.loop.advance(60ms);
  EXPECT_FALSE(reading.done());
  const auto writing = bench.command(kOther, {9, 0});
  const TimePoint given = Clock::now();
  ASSERT_TRUE(bench.loop.advance_until([&] { return writing.done(); }, 800ms));
  EXPECT_TRUE(writing.get().has_value()) << to_string(writing.get().error());
  EXPECT_LT(Clock::now() - given, 50ms) << "what is left of one sub-block";
  EXPECT_EQ(bench.node.server.objects[kOther], (Bytes{9, 0}));
  ASSERT_EQ(bench.node.server.aborts_heard().size(), 1U);
  EXPECT_EQ(bench.node.server.aborts_heard()[0].code, 0x08000000U);
  ASSERT_TRUE(bench.loop.advance_until([&] { return reading.done(); }, 5s));
  ASSERT_TRUE(reading.get().has_value()) << to_string(reading.get().error());
  EXPECT_EQ(reading.get().value(), data);
}

TEST(SdoBlockClient, AStopEndsABlockUploadToo) {
  SdoFaultBench bench(by_block(), 125'000);
  bench.node.server.objects[kFile] = SdoFaultBench::counted(2000);
  const auto reading = bench.read(kFile);
  bench.loop.advance(60ms);
  const auto stopping =
      support::spawn(bench.loop.executor(), bench.client->write_stop(kOther, DataType::u16, 9, Clock::now() + 800ms));
  const TimePoint given = Clock::now();
  ASSERT_TRUE(bench.loop.advance_until([&] { return stopping.done(); }, 800ms));
  EXPECT_TRUE(stopping.get().has_value()) << to_string(stopping.get().error());
  EXPECT_LT(Clock::now() - given, 50ms);
  ASSERT_TRUE(bench.loop.advance_until([&] { return reading.done(); }, 5s));
  EXPECT_TRUE(reading.get().has_value());
}

TEST(SdoBlockClient, AStopEndsABlockDownloadAfterItsPatience) {
  SdoFaultBench bench(by_block(), 125'000);
  bench.node.server.objects[kFile] = {0};
  const auto writing = bench.command(kFile, SdoFaultBench::counted(4000), 5s);
  bench.loop.advance(60ms);
  const auto stopping =
      support::spawn(bench.loop.executor(), bench.client->write_stop(kOther, DataType::u16, 9, Clock::now() + 800ms));
  ASSERT_TRUE(bench.loop.advance_until([&] { return stopping.done(); }, 200ms));
  EXPECT_TRUE(stopping.get().has_value()) << to_string(stopping.get().error());
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().error().outcome_unknown);
  EXPECT_EQ(bench.node.server.objects[kFile], Bytes{0}) << "aborted";
  EXPECT_TRUE(bench.node.server.idle());
}

TEST(SdoBlockClient, UploadsThatCommandsKeepEndingAreGivenUp) {
  SdoFaultBench bench(by_block(), 125'000);
  bench.node.server.objects[kFile] = SdoFaultBench::counted(20'000);
  const auto reading = bench.read(kFile);
  unsigned commands = 0;
  while (!reading.done() && commands < 2 * SdoClient::kMostGivenUp) {
    bench.loop.advance(150ms);
    const auto writing = bench.command(kOther, {9, 0});
    ASSERT_TRUE(bench.loop.advance_until([&] { return writing.done(); }, 800ms));
    ASSERT_TRUE(writing.get().has_value()) << to_string(writing.get().error());
    ++commands;
  }
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::timeout);
  EXPECT_EQ(commands, SdoClient::kMostGivenUp);
}

// Nothing else of the bus is late because of a long upload: the server's sub-blocks are asked for within the budget.
TEST(SdoBlockClient, ALongUploadKeepsWithinTheLoadThatSdoMayReach) {
  SdoFaultBench bench(by_block(), 125'000);
  bench.node.server.objects[kFile] = SdoFaultBench::counted(7000);
  const auto reading = bench.read(kFile);
  const TimePoint begun = Clock::now();
  ASSERT_TRUE(bench.loop.advance_until([&] { return reading.done(); }, 10s));
  ASSERT_TRUE(reading.get().has_value());
  // 1 000 segments of 111 bits and 33 acknowledgements are 0.92 s of this bus.
  const Duration took = Clock::now() - begun;
  EXPECT_GT(took, 1200ms);
  EXPECT_LT(took, 1600ms);
}

}  // namespace
}  // namespace canopen
