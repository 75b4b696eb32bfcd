#include "daemon/command_log.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "config/model.h"

namespace gateway {
namespace {

using namespace std::chrono_literals;
using canopen::Error;
using canopen::ErrorKind;
using process::CommandRecord;
using process::FieldRecord;
using process::Outcome;
using Lines = std::vector<std::string>;

class CommandLogTest : public testing::Test {
 protected:
  CommandLogTest() {
    drive_.name = "pump1";
    drive_.signals.resize(2);
    drive_.signals[0].name = "control_command";
    drive_.signals[1].name = "frequency_command";
    drive_.signals[1].scale = 0.01;
    drive_.signals[1].decimals = 2;
    drive_.signals[1].unit = "Hz";
  }

  CommandRecord record(std::vector<FieldRecord> fields, std::string address = "192.0.2.7") {
    CommandRecord made;
    made.id = "a" + std::to_string(++count_);
    made.writer = {.way = process::Writer::Way::modbus, .address = std::move(address)};
    made.drive = &drive_;
    made.fields = std::move(fields);
    for (const FieldRecord& field : made.fields) {
      made.writes_control = made.writes_control || field.signal == 0;
    }
    made.arrived = now_;
    return made;
  }
  void done(const CommandRecord& record, const Outcome& outcome = {}) { log_.on_done(record, outcome, now_ + 12ms); }
  void set_point(canopen::Raw raw, std::string address = "192.0.2.7") {
    done(record({{.signal = 1, .asked = raw}}, std::move(address)));
  }
  static Outcome failure(ErrorKind kind, std::string detail = "") {
    return Error{.kind = kind, .detail = std::move(detail)};
  }
  Lines taken() { return std::exchange(lines_, {}); }

  config::Drive drive_;
  canopen::TimePoint now_ = canopen::TimePoint{} + 1h;
  int count_ = 0;
  Lines lines_;
  CommandLog log_{[this](const std::string& line) { lines_.push_back(line); }};
};

TEST_F(CommandLogTest, SaysWhoAskedForWhatAndWhatBecameOfIt) {
  done(record({{.signal = 0, .asked = 1}, {.signal = 1, .asked = 3000}}));
  EXPECT_EQ(taken(),
            Lines{"pump1: modbus 192.0.2.7: control_command 1, frequency_command 30.00 Hz: ok in 12 ms (id a1)"});
  done(record({{.signal = 1, .asked = {}}}), failure(ErrorKind::range, "frequency_command: out of range 0..50"));
  EXPECT_EQ(taken(), Lines{"pump1: modbus 192.0.2.7: frequency_command (no value): refused range: frequency_command: "
                           "out of range 0..50, after 12 ms (id a2)"});
  Outcome noted;
  noted.unchanged = true;
  noted.note = "by SDO";
  done(record({{.signal = 0, .asked = 7}}), noted);
  EXPECT_EQ(taken(), Lines{"pump1: modbus 192.0.2.7: control_command 7: ok, unchanged, in 12 ms, by SDO (id a3)"});
}

TEST_F(CommandLogTest, TellsWhatTheDriveRefusedAndWhatNobodyKnows) {
  done(record({{.signal = 0, .asked = 1}}), Error{.kind = ErrorKind::timeout, .outcome_unknown = true});
  done(record({{.signal = 0, .asked = 1}}), Error{.kind = ErrorKind::refused, .abort = 0x06090030});
  const Lines lines = taken();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NE(lines[0].find(": timeout, outcome unknown, after 12 ms"), std::string::npos) << lines[0];
  EXPECT_NE(lines[1].find(": refused: SDO abort 0x06090030"), std::string::npos) << lines[1];
}

TEST_F(CommandLogTest, NamesNmtCommandsAndObjects) {
  CommandRecord nmt = record({});
  nmt.kind = CommandRecord::Kind::nmt;
  nmt.nmt = canopen::NmtCommand::reset_node;
  done(nmt);
  CommandRecord raw = record({});
  raw.kind = CommandRecord::Kind::raw;
  raw.object = canopen::ObjectValue{{0x2002, 3}, canopen::DataType::u16, 77};
  done(raw);
  EXPECT_EQ(taken(), (Lines{"pump1: modbus 192.0.2.7: NMT reset-node: ok in 12 ms (id a1)",
                            "pump1: modbus 192.0.2.7: object 0x2002:03 = 77: ok in 12 ms (id a2)"}));
}

TEST_F(CommandLogTest, OfManySetPointsOfAWriterThereIsALineASecondThatCountsTheOthers) {
  for (int i = 0; i < 40; ++i, now_ += 50ms) {
    set_point(100 + canopen::Raw(i));
  }
  EXPECT_EQ(taken(),
            (Lines{"pump1: modbus 192.0.2.7: frequency_command 1.00 Hz: ok in 12 ms (id a1)",
                   "pump1: modbus 192.0.2.7: frequency_command 1.20 Hz: ok in 12 ms (id a21, and 19 before it)"}));
  set_point(1, "192.0.2.8");
  EXPECT_EQ(taken().size(), 2U) << "another writer; and the second of the first is over";
}

TEST_F(CommandLogTest, WhatWasLeftOutIsToldEvenWhereNoneOfItsKindFollows) {
  set_point(1);
  set_point(2);
  now_ += 1s;
  taken();
  done(record({{.signal = 0, .asked = 5}}));
  EXPECT_EQ(taken(), (Lines{"pump1: modbus 192.0.2.7: 1 more: set-points",
                            "pump1: modbus 192.0.2.7: control_command 5: ok in 12 ms (id a3)"}));
}

TEST_F(CommandLogTest, EveryControlCommandThatWasCarriedOutHasALine) {
  for (int i = 0; i < 20; ++i) {
    done(record({{.signal = 0, .asked = 1}}));
    done(record({{.signal = 0, .asked = 1}}), Error{.kind = ErrorKind::timeout, .outcome_unknown = true});
  }
  EXPECT_EQ(taken().size(), 40U);
}

TEST_F(CommandLogTest, RefusalsAreTakenTogetherByTheirKind) {
  for (int i = 0; i < 20; ++i) {
    done(record({{.signal = 0, .asked = 1}}), failure(ErrorKind::lease));
    done(record({{.signal = 0, .asked = 1}}), failure(ErrorKind::forbidden));
  }
  EXPECT_EQ(taken().size(), 2U);
  now_ += 1min;
  done(record({{.signal = 0, .asked = 1}}), failure(ErrorKind::lease));
  const Lines lines = taken();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0], "pump1: modbus 192.0.2.7: 19 more: refused forbidden");
  EXPECT_NE(lines[1].find("(id a41, and 19 before it)"), std::string::npos) << lines[1];
}

TEST_F(CommandLogTest, AModbusClientThatPollsWhatItIsRefusedIsALineAMinute) {
  for (int i = 0; i < 600; ++i, now_ += 100ms) {
    done(record({{.signal = 0, .asked = 1}}), failure(ErrorKind::forbidden));
    done(record({{.signal = 0, .asked = 1}}, "192.0.2.8"), failure(ErrorKind::forbidden));
  }
  EXPECT_EQ(taken().size(), 2U) << "one for each address";
  done(record({{.signal = 0, .asked = 1}}), failure(ErrorKind::forbidden));
  const Lines lines = taken();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0], "pump1: modbus 192.0.2.8: 599 more: refused forbidden");
  EXPECT_NE(lines[1].find(", and 599 before it)"), std::string::npos) << lines[1];
}

TEST_F(CommandLogTest, ClientsThatChangeTheirAddressDoNotFillTheLog) {
  for (int i = 0; i < 3000; ++i) {
    done(record({{.signal = 0, .asked = 1}}, std::to_string(i)), failure(ErrorKind::forbidden));
  }
  EXPECT_EQ(taken().size(), 1001U);
  now_ += 1min;
  done(record({{.signal = 0, .asked = 5}}));
  const Lines lines = taken();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0], "all drives: other writers: 1999 more: refused forbidden");
}

TEST_F(CommandLogTest, RefusalsByOtherWaysAreALineASecond) {
  for (int i = 0; i < 20; ++i, now_ += 100ms) {
    CommandRecord made = record({{.signal = 0, .asked = 1}});
    made.writer = {.way = process::Writer::Way::mqtt, .address = {}};
    done(made, failure(ErrorKind::range));
  }
  EXPECT_EQ(taken().size(), 2U);
}

TEST_F(CommandLogTest, NamesWhatWasNoCommandToo) {
  CommandRecord nmt = record({});
  nmt.kind = CommandRecord::Kind::nmt;
  done(nmt, failure(ErrorKind::type, "7 is no number of an NMT command"));
  CommandRecord raw = record({});
  raw.kind = CommandRecord::Kind::raw;
  done(raw, failure(ErrorKind::unknown));
  const Lines lines = taken();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_TRUE(lines[0].starts_with("pump1: modbus 192.0.2.7: NMT (no command): refused type: 7 is no")) << lines[0];
  EXPECT_TRUE(lines[1].starts_with("pump1: modbus 192.0.2.7: object (no request): refused unknown")) << lines[1];
}

}  // namespace
}  // namespace gateway
