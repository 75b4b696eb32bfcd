#include "bridges/journal/record_text.h"

#include <gtest/gtest.h>

#include "canopen/error.h"
#include "tests/unit/journal/commands.h"

namespace journal {
namespace {

using canopen::Error;
using canopen::ErrorKind;
using process::CommandRecord;
using process::Writer;

const config::Drive kPump = make_pump();

TEST(JournalRecord, WhoCommands) {
  CommandRecord record = make_write(kPump, "a", {});
  EXPECT_EQ(who_text(record), R"("writer":"modbus","from":"192.0.2.7","drive":"pump1")");
  record.writer = {Writer::Way::mqtt, "", ""};
  EXPECT_EQ(who_text(record), R"("writer":"mqtt","drive":"pump1")");
  record.writer = {Writer::Way::local, "", "operator"};
  EXPECT_EQ(who_text(record), R"("writer":"local","from":"operator","drive":"pump1")");
}

TEST(JournalRecord, AWriteTellsWhatWasBeforeAskedAndConfirmedInEngineeringUnits) {
  const CommandRecord record =
      make_write(kPump, "a\"b", {{.signal = 0, .before = 5, .asked = 1, .confirmed = 1}, {.signal = 1, .asked = 4997}});
  EXPECT_EQ(what_text(record),
            R"("id":"a\"b","fields":[{"signal":"control_command","before":5,"asked":1,"confirmed":1},)"
            R"({"signal":"frequency_command","asked":49.97}])");
}

TEST(JournalRecord, AValueThatWasNone) {
  EXPECT_EQ(what_text(make_write(kPump, "a", {{.signal = 1}})),
            R"("id":"a","fields":[{"signal":"frequency_command","asked":null}])");
  EXPECT_EQ(what_text(make_write(kPump, "a", {{.signal = 1, .given = 70000.5}})),
            R"("id":"a","fields":[{"signal":"frequency_command","asked":70000.5}])");
}

TEST(JournalRecord, NmtAndRawWritesHaveTheirOwnMembers) {
  CommandRecord record = make_write(kPump, "a", {});
  record.kind = CommandRecord::Kind::nmt;
  record.nmt = canopen::NmtCommand::reset_node;
  EXPECT_EQ(what_text(record), R"("id":"a","nmt":"reset-node")");
  record.kind = CommandRecord::Kind::raw;
  record.object = canopen::ObjectValue{{0x2000, 1}, canopen::DataType::i16, static_cast<canopen::Raw>(-3)};
  EXPECT_EQ(what_text(record), R"("id":"a","object":"0x2000:01","type":"i16","asked":-3)");
  record.bytes = {0x01, 0xA0, 0x0F};
  EXPECT_EQ(what_text(record), R"("id":"a","object":"0x2000:01","bytes":"01A00F")");
}

TEST(JournalRecord, WhatCameOfIt) {
  const CommandRecord record = make_write(kPump, "a", {});
  const auto later = record.arrived + std::chrono::milliseconds(12);
  process::Outcome outcome;
  EXPECT_EQ(code_of(outcome), "ok");
  EXPECT_EQ(result_text(record, outcome, later), R"("ms":12)");
  outcome.unchanged = true;
  outcome.note = "told";
  EXPECT_EQ(result_text(record, outcome, later), R"("ms":12,"unchanged":true,"note":"told")");
}

TEST(JournalRecord, AFailureHasTheCodeOfTheAnswerItsTextAndTheAbort) {
  const CommandRecord record = make_write(kPump, "a", {});
  const Error error{.kind = ErrorKind::refused, .node = 5, .object = {0x2000, 0}, .abort = 0x06090030};
  process::Outcome outcome = error;
  outcome.written = 1;
  EXPECT_EQ(code_of(outcome), "refused");
  EXPECT_EQ(result_text(record, outcome, record.arrived),
            R"("ms":0,"written":1,"abort":"0x06090030","error":")" + canopen::to_string(error) + '"');
}

}  // namespace
}  // namespace journal
