// Whatever goes wrong with one frame of an SDO, in each mode: what the caller is told, and that it is true.

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/unit/canopen/sdo_fault_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using Bytes = SdoFaultBench::Bytes;

enum class Mode : std::uint8_t { expedited, segmented, block };

constexpr std::array kModes{Mode::expedited, Mode::segmented, Mode::block};
constexpr std::array kFaults{WireFault::request_lost,
                             WireFault::lost,
                             WireFault::late,
                             WireFault::doubled,
                             WireFault::wrong_toggle,
                             WireFault::wrong_index,
                             WireFault::cut,
                             WireFault::abort_without_code,
                             WireFault::abort_without_object,
                             WireFault::abort_of_another,
                             WireFault::foreign_client};

const char* name_of(Mode mode) {
  return std::array{"expedited", "segmented", "block"}.at(static_cast<std::size_t>(mode));
}
const char* name_of(WireFault fault) {
  return std::array{"none",
                    "request lost",
                    "lost",
                    "late",
                    "doubled",
                    "wrong toggle",
                    "wrong index",
                    "cut",
                    "abort without code",
                    "abort without object",
                    "abort of another object",
                    "foreign client"}
      .at(static_cast<std::size_t>(fault));
}
// Three sub-blocks of an upload.
std::size_t bytes_of(Mode mode) {
  return mode == Mode::expedited ? 2 : mode == Mode::segmented ? 60 : 65 * 7 - 3;
}
SdoSettings settings_of(Mode mode) {
  SdoSettings settings;
  settings.block = mode == Mode::block;
  return settings;
}

/// What the caller is told.
enum class Told : std::uint8_t { well, timeout, refused, protocol };
template <class T>
Told told_by(const Result<T>& result) {
  if (result.has_value()) {
    return Told::well;
  }
  return result.error().kind == ErrorKind::refused    ? Told::refused
         : result.error().kind == ErrorKind::protocol ? Told::protocol
                                                      : Told::timeout;
}

struct Outcome {
  Told told = Told::well;
  bool unknown = false;
  std::size_t requests = 0;
  std::size_t answers = 0;
  std::size_t begun = 0;  ///< First requests for the object.
  bool foreign = false;
};

// Of the client and the server after a fault: both can go on.
void expect_usable(SdoFaultBench& bench) {
  bench.node.fault = WireFault::none;
  const auto after = bench.read(SdoFaultBench::kOther);
  ASSERT_TRUE(bench.loop.advance_until([&] { return after.done(); }, 10s));
  ASSERT_TRUE(after.get().has_value()) << to_string(after.get().error());
  EXPECT_EQ(after.get().value(), (Bytes{7, 0}));
  EXPECT_TRUE(bench.node.server.idle());
}

std::size_t begun(const SdoFaultBench& bench) {
  return static_cast<std::size_t>(std::ranges::count_if(bench.node.requests, [](const Frame& frame) {
    const auto kind = sdo_request_of(frame.data[0]);
    return begins_transfer(kind) && address_of(frame.bytes()) == SdoFaultBench::kFile;
  }));
}

Outcome upload(Mode mode, WireFault fault, std::size_t at) {
  SdoFaultBench bench(settings_of(mode));
  const Bytes data = SdoFaultBench::counted(bytes_of(mode));
  bench.node.server.objects[SdoFaultBench::kFile] = data;
  bench.node.fault = fault;
  bench.node.at = at;
  const auto reading = bench.read(SdoFaultBench::kFile);
  EXPECT_TRUE(bench.loop.advance_until([&] { return reading.done(); }, 20s));
  Outcome outcome;
  if (!reading.done()) {
    return outcome;
  }
  outcome.told = told_by(reading.get());
  EXPECT_TRUE(reading.get().has_error() || reading.get().value() == data) << "no data but the right ones";
  bench.loop.advance(1s);
  outcome.requests = bench.node.requests.size();
  outcome.answers = bench.node.frames;
  outcome.begun = begun(bench);
  outcome.foreign = bench.node.foreign_sent;
  expect_usable(bench);
  return outcome;
}

Outcome download(Mode mode, WireFault fault, std::size_t at) {
  SdoFaultBench bench(settings_of(mode));
  const Bytes before = SdoFaultBench::counted(bytes_of(mode), 9);
  const Bytes data = SdoFaultBench::counted(bytes_of(mode));
  bench.node.server.objects[SdoFaultBench::kFile] = before;
  bench.node.server.faults.block_sizes = {30};
  bench.node.fault = fault;
  bench.node.at = at;
  const auto writing = bench.command(SdoFaultBench::kFile, data);
  EXPECT_TRUE(bench.loop.advance_until([&] { return writing.done(); }, 1s)) << "the deadline";
  Outcome outcome;
  if (!writing.done()) {
    return outcome;
  }
  outcome.told = told_by(writing.get());
  outcome.unknown = writing.get().has_error() && writing.get().error().outcome_unknown;
  if (outcome.told == Told::well) {
    EXPECT_EQ(bench.node.server.objects[SdoFaultBench::kFile], data);
  }
  // A server that aborts after it wrote is of another world.
  const bool aborted = fault == WireFault::abort_without_code || fault == WireFault::abort_without_object ||
                       fault == WireFault::abort_of_another;
  if (outcome.told != Told::well && !outcome.unknown && !aborted) {
    EXPECT_EQ(bench.node.server.objects[SdoFaultBench::kFile], before) << "a certain failure is certain";
  }
  bench.loop.advance(1s);
  outcome.requests = bench.node.requests.size();
  outcome.answers = bench.node.frames;
  outcome.begun = begun(bench);
  outcome.foreign = bench.node.foreign_sent;
  const bool block_refused = mode == Mode::block && fault == WireFault::abort_without_code;
  EXPECT_LE(outcome.begun, block_refused ? 2U : 1U) << "a command is sent once";
  expect_usable(bench);
  return outcome;
}

std::string where(const char* way, Mode mode, WireFault fault, std::size_t at) {
  return std::string(way) + ", " + name_of(mode) + ", " + name_of(fault) + " at frame " + std::to_string(at);
}

TEST(SdoFaultMatrix, WithoutFaultsAllIsWell) {
  for (const Mode mode : kModes) {
    SCOPED_TRACE(name_of(mode));
    const Outcome up = upload(mode, WireFault::none, 0);
    EXPECT_EQ(up.told, Told::well);
    EXPECT_EQ(up.begun, 1U);
    const Outcome down = download(mode, WireFault::none, 0);
    EXPECT_EQ(down.told, Told::well);
    EXPECT_EQ(down.begun, 1U);
  }
}

struct Cell {
  WireFault fault;
  /// Of the answer to the first request: expedited, segmented, block.
  std::array<Told, 3> up;
  std::array<Told, 3> down;
};

// A read is tried again, a command is not. By block transfer an abort without a code is a server that does not know it;
// there too, bit 4 of the first answer means nothing.
TEST(SdoFaultMatrix, WhatIsToldOfTheFirstAnswer) {
  using enum Told;
  const std::vector<Cell> cells{
      {WireFault::request_lost, {well, well, well}, {timeout, timeout, timeout}},
      {WireFault::lost, {well, well, well}, {timeout, timeout, timeout}},
      {WireFault::late, {well, well, well}, {well, well, well}},
      {WireFault::doubled, {well, well, well}, {well, well, well}},
      {WireFault::wrong_index, {well, well, well}, {timeout, timeout, timeout}},
      {WireFault::cut, {well, well, well}, {timeout, timeout, timeout}},
      {WireFault::abort_without_code, {refused, refused, well}, {refused, refused, well}},
      {WireFault::abort_without_object, {refused, refused, refused}, {refused, refused, refused}},
      {WireFault::abort_of_another, {well, well, well}, {timeout, timeout, timeout}},
      {WireFault::foreign_client, {well, well, well}, {timeout, timeout, timeout}},
  };
  for (const Cell& cell : cells) {
    for (const Mode mode : kModes) {
      const auto column = static_cast<std::size_t>(mode);
      SCOPED_TRACE(where("first answer", mode, cell.fault, 0));
      EXPECT_EQ(upload(mode, cell.fault, 0).told, cell.up.at(column));
      EXPECT_EQ(download(mode, cell.fault, 0).told, cell.down.at(column));
    }
  }
}

TEST(SdoFaultMatrix, AtAnyFrameOfAnUpload) {
  for (const Mode mode : kModes) {
    const Outcome usual = upload(mode, WireFault::none, 0);
    for (const WireFault fault : kFaults) {
      const std::size_t frames = fault == WireFault::request_lost ? usual.requests : usual.answers;
      // A segment has no index but data there, which block transfer alone checks.
      const bool is_data = fault == WireFault::wrong_index && mode == Mode::segmented;
      for (std::size_t at = 0; at < (is_data ? 1 : frames); ++at) {
        SCOPED_TRACE(where("upload", mode, fault, at));
        const Outcome outcome = upload(mode, fault, at);
        EXPECT_TRUE(fault != WireFault::foreign_client || outcome.foreign);
        // A server that is not in a block transfer any more refuses what follows.
        const bool unheard = fault == WireFault::abort_of_another && mode != Mode::block;
        if (fault == WireFault::request_lost || fault == WireFault::lost || fault == WireFault::late ||
            fault == WireFault::doubled || fault == WireFault::foreign_client || unheard) {
          EXPECT_EQ(outcome.told, Told::well) << "tried again where it has to be";
        }
        if (testing::Test::HasFailure()) {
          return;
        }
      }
    }
  }
}

TEST(SdoFaultMatrix, AtAnyFrameOfADownload) {
  for (const Mode mode : kModes) {
    const Outcome usual = download(mode, WireFault::none, 0);
    for (const WireFault fault : kFaults) {
      const std::size_t frames = fault == WireFault::request_lost ? usual.requests : usual.answers;
      for (std::size_t at = 0; at < frames; ++at) {
        SCOPED_TRACE(where("download", mode, fault, at));
        const Outcome outcome = download(mode, fault, at);
        EXPECT_TRUE(fault != WireFault::foreign_client || outcome.foreign);
        EXPECT_TRUE(fault != WireFault::doubled || outcome.told == Told::well);
        EXPECT_TRUE(outcome.told != Told::timeout || outcome.unknown);
        EXPECT_TRUE(fault != WireFault::abort_of_another || outcome.unknown) << "it says nothing of this transfer";
        if (testing::Test::HasFailure()) {
          return;
        }
      }
    }
  }
}

}  // namespace
}  // namespace canopen
