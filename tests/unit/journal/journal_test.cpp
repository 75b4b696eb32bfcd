#include "bridges/journal/journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/json/parse.hpp>
#include <boost/json/value.hpp>

#include "bridges/journal/verify.h"
#include "tests/unit/journal/commands.h"
#include "tests/unit/journal/disk.h"
#include "tests/unit/journal/loop.h"

namespace journal {
namespace {

using canopen::Error;
using canopen::ErrorKind;
using std::chrono::milliseconds;
using std::chrono::seconds;

class JournalOfCommands : public testing::Test {
 protected:
  ~JournalOfCommands() override { disk_.go_on(); }

  void SetUp() override { open(); }
  void open() {
    journal_ =
        std::make_unique<Journal>(loop_.executor(), Place{.directory = directory_.journal(), .calls = disk_.calls()},
                                  [this](const std::string& text) { told_.push_back(text); });
    journal_->start();
  }
  void begin(const process::CommandRecord& record) {
    const auto ended = loop_.start(journal_->begun(record));
    ASSERT_TRUE(loop_.run_until([&] { return *ended; }));
  }
  // Everything that was handed over so far stands on the disk.
  void drain() {
    const auto ended = loop_.start(journal_->queue().until_synced(canopen::kNever));
    ASSERT_TRUE(loop_.run_until([&] { return *ended; }));
  }
  [[nodiscard]] std::vector<boost::json::value> lines() {
    drain();
    std::vector<boost::json::value> all;
    for (const std::string& name : names_in(directory_.journal())) {
      for (const std::string& line : lines_of(directory_.journal() / name)) {
        all.push_back(boost::json::parse(line));
      }
    }
    return all;
  }
  [[nodiscard]] Report report() const {
    std::error_code failure;
    return verify(directory_.journal(), failure);
  }

  const config::Drive pump_ = make_pump();
  TemporaryDirectory directory_;
  Disk disk_;
  LoopWithThread loop_;
  std::vector<std::string> told_;
  std::unique_ptr<Journal> journal_;
};

TEST_F(JournalOfCommands, ARunHasALineBeforeAndOneAfter) {
  process::CommandRecord run = make_write(pump_, "a1", {{.signal = 0, .before = 5, .asked = 1}});
  begin(run);
  EXPECT_EQ(report().lines, 1U) << "on the disk before it is handed over";
  loop_.hand().advance(milliseconds(12));
  run.fields[0].confirmed = 1;
  journal_->done(run, {});
  const auto all = lines();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].at("n"), 1);
  EXPECT_EQ(all[0].at("phase"), "begun");
  EXPECT_EQ(all[0].at("writer"), "modbus");
  EXPECT_EQ(all[0].at("from"), "192.0.2.7");
  EXPECT_EQ(all[0].at("fields").at(0).at("asked"), 1);
  EXPECT_FALSE(all[0].as_object().contains("outcome"));
  EXPECT_EQ(all[1].at("phase"), "done");
  EXPECT_EQ(all[1].at("id"), "a1");
  EXPECT_EQ(all[1].at("outcome"), "ok");
  EXPECT_EQ(all[1].at("ms"), 12);
  EXPECT_EQ(all[1].at("fields").at(0).at("confirmed"), 1);
  EXPECT_EQ(all[1].at("prev"), sha256(lines_of(directory_.journal() / "2026-01-02.jsonl").at(0)).c_str());
  EXPECT_EQ(journal_->newest_hash(), report().newest_hash);
}

TEST_F(JournalOfCommands, EveryBegunCommandHasItsOwnEnd) {
  const process::CommandRecord run = make_write(pump_, "same", {{.signal = 0, .asked = 1}});
  for (int i = 0; i < 3; ++i) {
    begin(run);
    begin(run);
    journal_->done(run, Error{.kind = ErrorKind::superseded});
    journal_->done(run, Error{.kind = ErrorKind::superseded});
  }
  EXPECT_EQ(lines().size(), 12U);
}

TEST_F(JournalOfCommands, SetPointsOfOneWriterAreOneLineAMinute) {
  for (int i = 0; i < 15 * 61; ++i) {
    process::CommandRecord record =
        make_write(pump_, std::to_string(i), {{.signal = 1, .asked = 1000U + static_cast<unsigned>(i)}});
    journal_->done(record, {});
    loop_.hand().advance(milliseconds(67), milliseconds(67));
  }
  auto all = lines();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].at("id"), "0");
  EXPECT_EQ(all[1].at("count"), 895);
  EXPECT_EQ(all[1].at("first").at("id"), "1");
  EXPECT_EQ(all[1].at("first").at("fields").at(0).at("asked"), 10.01);
  EXPECT_EQ(all[1].at("last").at("id"), "895");
  const auto ended = loop_.start(journal_->stop());
  ASSERT_TRUE(loop_.run_until([&] { return *ended; }));
  all = lines();
  ASSERT_EQ(all.size(), 3U) << "at an orderly end nothing is lost";
  EXPECT_EQ(all[2].at("last").at("id"), "914");
  EXPECT_TRUE(report().sound());
}

TEST_F(JournalOfCommands, OtherSignalsWritersAndOutcomesHaveTheirOwn) {
  journal_->done(make_write(pump_, "a", {{.signal = 1, .asked = 1}}), {});
  process::CommandRecord other = make_write(pump_, "b", {{.signal = 1, .asked = 1}});
  other.writer = {process::Writer::Way::mqtt, ""};
  journal_->done(other, {});
  journal_->done(make_write(pump_, "c", {{.signal = 1, .asked = 1}}), Error{.kind = ErrorKind::superseded});
  journal_->done(make_write(pump_, "d", {{.signal = 1, .asked = 1}}), Error{.kind = ErrorKind::range});
  EXPECT_EQ(lines().size(), 4U);
}

TEST_F(JournalOfCommands, RefusalsOfOneKindAreOneLineAMinuteWhateverTheyWouldHaveWritten) {
  for (int i = 0; i < 100; ++i) {
    const auto signal = static_cast<process::SignalId>(i % 2);
    journal_->done(make_write(pump_, std::to_string(i), {{.signal = signal, .asked = 1}}),
                   Error{.kind = ErrorKind::forbidden});
  }
  loop_.hand().advance(seconds(60), seconds(1));
  const auto all = lines();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[1].at("outcome"), "forbidden");
  EXPECT_EQ(all[1].at("count"), 99);
  EXPECT_TRUE(all[1].at("last").as_object().contains("error"));
}

TEST_F(JournalOfCommands, WhatMayHaveTakenEffectHasItsOwnLine) {
  process::CommandRecord raw = make_write(pump_, "raw", {});
  raw.kind = process::CommandRecord::Kind::raw;
  raw.object = canopen::ObjectValue{{0x2000, 0}, canopen::DataType::u16, 1};
  process::CommandRecord nmt = make_write(pump_, "nmt", {});
  nmt.kind = process::CommandRecord::Kind::nmt;
  nmt.nmt = canopen::NmtCommand::stop;
  for (int i = 0; i < 3; ++i) {
    journal_->done(raw, {});
    journal_->done(nmt, {});
    journal_->done(raw, Error{.kind = ErrorKind::timeout, .outcome_unknown = true});
    journal_->done(make_write(pump_, "run", {{.signal = 0, .asked = 1}}), {});
  }
  EXPECT_EQ(lines().size(), 12U);
}

TEST_F(JournalOfCommands, ManyKindsTakeBoundedMemoryAndLoseNothing) {
  for (int i = 0; i < 3000; ++i) {
    process::CommandRecord record = make_write(pump_, "x", {{.signal = 1, .asked = 1}});
    record.writer.address = std::to_string(i);
    journal_->done(record, {});
    journal_->done(record, {});
  }
  const auto ended = loop_.start(journal_->stop());
  ASSERT_TRUE(loop_.run_until([&] { return *ended; }));
  const auto all = lines();
  EXPECT_EQ(all.size(), 2002U) << "of a thousand kinds two each, and two of all others";
  std::int64_t commands = 0;
  for (const boost::json::value& line : all) {
    const boost::json::value* const count = line.as_object().if_contains("count");
    commands += count == nullptr ? 1 : count->as_int64();
  }
  EXPECT_EQ(commands, 6000);
  const auto others = std::ranges::find_if(all, [](const auto& line) { return line.as_object().contains("count"); });
  ASSERT_NE(others, all.end());
  EXPECT_EQ(others->at("outcome"), "ok");
  EXPECT_FALSE(others->as_object().contains("drive"));
  EXPECT_EQ(others->at("first").at("from"), "1000");
  EXPECT_EQ(others->at("last").at("from"), "2999");
  EXPECT_TRUE(report().sound());
}

TEST_F(JournalOfCommands, MoreKindsThanCanBeCountedAreNoLineForEach) {
  for (int i = 0; i < 20 * 1500; ++i) {
    process::CommandRecord record = make_write(pump_, "x", {{.signal = 1, .asked = 1}});
    record.writer.address = std::to_string(i % 1500);
    journal_->done(record, Error{.kind = ErrorKind::forbidden});
  }
  EXPECT_EQ(lines().size(), 1001U);
}

TEST_F(JournalOfCommands, ARunIsNotHeldBackByADiskThatHangs) {
  drain();
  disk_.hang();
  const auto ended = loop_.start(journal_->begun(make_write(pump_, "a1", {{.signal = 0, .asked = 1}})));
  disk_.await_hanging();
  loop_.hand().advance(milliseconds(50));
  EXPECT_TRUE(*ended);
  EXPECT_EQ(journal_->queue().passed_by(), 1U);
}

TEST_F(JournalOfCommands, GoesOnAfterARestart) {
  journal_->done(make_write(pump_, "a", {{.signal = 1, .asked = 1}}), {});
  drain();
  journal_.reset();
  open();
  journal_->done(make_write(pump_, "b", {{.signal = 1, .asked = 1}}), {});
  const auto all = lines();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[1].at("n"), 2);
  EXPECT_TRUE(report().sound()) << report().broken;
}

}  // namespace
}  // namespace journal
