#include "bridges/mqtt/answers.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <string>

namespace mqtt {
namespace {

using canopen::DataType;
using canopen::Error;
using canopen::ErrorKind;
using canopen::Raw;

const ReplyTo kTo{.topic = "r/1", .correlation = "c", .command_topic = "B/pump1/set", .id = R"("a1")"};

canopen::Result<Raw> read(Raw raw) {
  return raw;
}

TEST(Answers, OfACommandThatWasDone) {
  const Message message = command_answer(kTo, {});
  EXPECT_EQ(message.payload, R"({"ok":true,"topic":"B/pump1/set","id":"a1"})");
  EXPECT_EQ(message.topic, "r/1");
  EXPECT_EQ(message.correlation, "c");
  EXPECT_EQ(message.kind, MessageKind::answer);
  EXPECT_FALSE(message.retained);
}

TEST(Answers, OfACommandThatWasNot) {
  ReplyTo to = kTo;
  to.id.clear();
  EXPECT_EQ(command_answer(to, Error{.kind = ErrorKind::range, .detail = "out of range 0..50"}).payload,
            R"({"ok":false,"code":"range","error":"out of range 0..50","topic":"B/pump1/set"})");
}

TEST(Answers, TellWhatElseThereIsToSay) {
  process::Outcome outcome;
  outcome.id = "0badcafe-7";
  outcome.unchanged = true;
  outcome.note = "by SDO";
  EXPECT_EQ(command_answer(kTo, outcome).payload,
            R"({"ok":true,"topic":"B/pump1/set","id":"a1","unchanged":true,"note":"by SDO"})")
      << "the client's own id goes before the one that was made";
  ReplyTo to = kTo;
  to.id.clear();
  outcome.unchanged = false;
  outcome.note.clear();
  EXPECT_EQ(command_answer(to, outcome).payload, R"({"ok":true,"topic":"B/pump1/set","id":"0badcafe-7"})");
  to.sdo = true;
  EXPECT_EQ(command_answer(to, outcome).payload, R"({"id":"0badcafe-7","ok":true})");
}

TEST(Answers, ToRepetitionsHaveTheFirstOutcomeBesideThem) {
  EXPECT_EQ(first_outcome({}), R"({"ok":true})");
  const std::string refused = first_outcome(Error{.kind = ErrorKind::refused, .abort = 0x08000022});
  EXPECT_TRUE(refused.starts_with(R"({"ok":false,"code":"refused","abort":"0x08000022","error":")")) << refused;
  const std::string text = R"("ok":false,"code":"duplicate","error":"the same command came within the last 60 s")";
  EXPECT_EQ(duplicate_answer(kTo, R"({"ok":true})").payload,
            "{" + text + R"(,"first":{"ok":true},"topic":"B/pump1/set","id":"a1"})");
  EXPECT_EQ(duplicate_answer(kTo, std::nullopt).payload, "{" + text + R"(,"topic":"B/pump1/set","id":"a1"})");
  ReplyTo to = kTo;
  to.sdo = true;
  EXPECT_EQ(duplicate_answer(to, R"({"ok":true})").payload, R"({"id":"a1",)" + text + R"(,"first":{"ok":true}})");
}

TEST(Answers, NameTheAbortCodeAndADoubtfulOutcome) {
  const std::string refused = command_answer(kTo, Error{.kind = ErrorKind::refused, .abort = 0x06020000}).payload;
  EXPECT_NE(refused.find(R"("code":"refused","abort":"0x06020000","error":")"), std::string::npos) << refused;
  EXPECT_NE(refused.find("Object does not exist"), std::string::npos) << refused;
  const std::string timeout =
      command_answer(kTo, Error{.kind = ErrorKind::timeout, .outcome_unknown = true, .detail = "x"}).payload;
  EXPECT_NE(timeout.find("timeout, outcome unknown"), std::string::npos) << timeout;
}

TEST(Answers, OfSdoRequests) {
  EXPECT_EQ(sdo_answer(kTo, read(0), DataType::u16).payload, R"({"id":"a1","ok":true,"value":0})");
  EXPECT_EQ(sdo_answer(kTo, read(static_cast<Raw>(-5)), DataType::i8).payload, R"({"id":"a1","ok":true,"value":-5})");
  EXPECT_EQ(sdo_answer(kTo, read(18446744073709551615U), DataType::u64).payload,
            R"({"id":"a1","ok":true,"value":18446744073709551615})");
  EXPECT_EQ(sdo_answer(kTo, read(1), DataType::boolean).payload, R"({"id":"a1","ok":true,"value":true})");
  EXPECT_EQ(sdo_answer(kTo, read(std::bit_cast<Raw>(std::numeric_limits<double>::quiet_NaN())), DataType::f64).payload,
            R"({"id":"a1","ok":true,"value":null})");
  const std::string refused =
      sdo_answer(kTo, Error{.kind = ErrorKind::refused, .abort = 0x06020000}, DataType::u16).payload;
  EXPECT_TRUE(refused.starts_with(R"({"id":"a1","ok":false,"code":"refused","abort":"0x06020000","error":")"))
      << refused;
}

TEST(Answers, OfSdoRequestsForTextAndBytes) {
  const std::vector<std::uint8_t> name{'"', 'A', 0xFF, 0};
  EXPECT_EQ(sdo_answer(kTo, name, SdoForm::text).payload, R"({"id":"a1","ok":true,"value":"\"A)"
                                                          "\xEF\xBF\xBD"
                                                          R"("})")
      << "what is no text is replaced";
  EXPECT_EQ(sdo_answer(kTo, name, SdoForm::bytes).payload, R"({"id":"a1","ok":true,"value":"2241FF00"})");
  const Error refused{.kind = ErrorKind::refused, .abort = 0x06020000};
  EXPECT_TRUE(
      sdo_answer(kTo, refused, SdoForm::bytes).payload.starts_with(R"({"id":"a1","ok":false,"code":"refused",)"));
}

}  // namespace
}  // namespace mqtt
