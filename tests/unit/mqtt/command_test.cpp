#include "bridges/mqtt/command.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "bridges/mqtt/sdo_request.h"
#include "tests/unit/mqtt/site.h"

namespace mqtt {
namespace {

using canopen::ErrorKind;
using canopen::Raw;

const config::Drive kPump = test::pump1();

canopen::Result<process::FieldWrite> set(std::size_t signal, std::string_view payload) {
  const Parsed parsed = parse_value(payload);
  if (parsed.members.has_error()) {
    return parsed.members.error();
  }
  return field_of(kPump, signal, parsed.members.value().front().second);
}

process::GivenValue value_of(std::size_t signal, std::string_view payload) {
  const auto field = set(signal, payload);
  EXPECT_TRUE(field.has_value()) << payload << ": " << (field.has_error() ? field.error().detail : "");
  return field.has_value() ? field.value().value : process::GivenValue(-1.0);
}

ErrorKind error_of(std::size_t signal, std::string_view payload) {
  const auto field = set(signal, payload);
  EXPECT_TRUE(field.has_error()) << payload;
  return field.has_error() ? field.error().kind : ErrorKind::protocol;
}

using Value = process::GivenValue;

TEST(Command, NumbersAreEngineeringUnits) {
  EXPECT_EQ(value_of(test::kFrequencyCommand, "49.97"), Value(49.97));
  EXPECT_EQ(value_of(test::kFrequencyCommand, " 30\n"), Value(30.0));
  EXPECT_EQ(value_of(test::kFrequencyCommand, "1e1"), Value(10.0));
  EXPECT_EQ(value_of(test::kFrequencyCommand, "050"), Value(50.0)) << "plain text need not be JSON";
  EXPECT_EQ(value_of(test::kFrequencyCommand, ".5"), Value(0.5));
  EXPECT_EQ(value_of(test::kFrequencyCommand, "5."), Value(5.0));
  EXPECT_EQ(value_of(test::kFrequencyCommand, R"({"value":49.97,"id":"a1"})"), Value(49.97));
  EXPECT_EQ(value_of(test::kControlCommand, "-1"), Value(-1.0)) << "the arbiter knows the range";
}

TEST(Command, WhatIsNoFiniteNumberIsATypeError) {
  for (const char* payload : {"fast", "NaN", "nan", "inf", "-inf", "1,5", "0x10", "5 0", "+5", "true", "\"30\"",
                              R"({"value":"30"})", R"({"value":null})", R"({"value":true})", "stopped", " ", "1.5.2"}) {
    EXPECT_EQ(error_of(test::kFrequencyCommand, payload), ErrorKind::type) << payload;
  }
  EXPECT_EQ(error_of(test::kFrequencyCommand, "1e999"), ErrorKind::range);
  EXPECT_EQ(error_of(test::kFrequencyCommand, R"({"value":-1e999})"), ErrorKind::range);
}

TEST(Command, KeepsAllDigitsOf64Bits) {
  EXPECT_EQ(value_of(test::kCounter, "18446744073709551615"), Value(Raw{18446744073709551615U}));
  EXPECT_EQ(value_of(test::kCounter, R"({"value":9007199254740993})"), Value(Raw{9007199254740993U}));
  EXPECT_EQ(value_of(test::kCounter, "1.5"), Value(1.5));
  EXPECT_EQ(value_of(test::kCounter, "-0"), Value(Raw{0}));
  EXPECT_EQ(error_of(test::kCounter, "18446744073709551616"), ErrorKind::range);
  EXPECT_EQ(error_of(test::kCounter, "-1"), ErrorKind::range);
}

TEST(Command, NamesAndBooleansStandForTheirRawValue) {
  EXPECT_EQ(value_of(test::kMode, "torque"), Value(Raw{1}));
  EXPECT_EQ(value_of(test::kMode, R"({"value":"speed"})"), Value(Raw{0}));
  EXPECT_EQ(value_of(test::kMode, "1"), Value(1.0));
  EXPECT_EQ(error_of(test::kMode, "unknown(1)"), ErrorKind::type);
  EXPECT_NE(set(test::kMode, "position").error().detail.find("none of speed, torque"), std::string::npos);
  EXPECT_EQ(value_of(test::kSwitch, "true"), Value(Raw{1}));
  EXPECT_EQ(value_of(test::kSwitch, R"({"value":false})"), Value(Raw{0}));
  EXPECT_EQ(value_of(test::kSwitch, "1"), Value(1.0));
}

TEST(Command, ReadOnlySignalsTakeNothing) {
  EXPECT_EQ(error_of(test::kFrequency, "1"), ErrorKind::read_only);
  EXPECT_EQ(error_of(test::kRunning, "true"), ErrorKind::read_only);
}

TEST(Command, EchoesTheIdAsItWasGiven) {
  EXPECT_EQ(parse_value(R"({"value":1,"id":"a\"1"})").id, R"("a\"1")");
  EXPECT_EQ(parse_value(R"({"id":7,"value":1})").id, "7");
  EXPECT_EQ(parse_value("1").id, "");
  EXPECT_TRUE(parse_value(R"({"value":1,"id":null})").members.has_error());
}

TEST(Command, RefusesUnknownMembers) {
  const Parsed parsed = parse_value(R"({"valeu":1,"id":"a1"})");
  ASSERT_TRUE(parsed.members.has_error());
  EXPECT_NE(parsed.members.error().detail.find("valeu"), std::string::npos);
  EXPECT_EQ(parsed.id, R"("a1")");
  EXPECT_TRUE(parse_value(R"({"id":"a1"})").members.has_error());
  EXPECT_TRUE(parse_value("{}").members.has_error());
}

TEST(Command, RefusesPayloadsThatAreTooLong) {
  EXPECT_EQ(parse_value(std::string(kMaxCommand + 1, '1')).members.error().kind, ErrorKind::type);
  EXPECT_EQ(parse_object_payload("{" + std::string(kMaxCommand, ' ') + "}").members.error().kind, ErrorKind::type);
}

TEST(Command, SetTakesSeveralSignalsInTheirOrder) {
  const Parsed parsed = parse_object_payload(R"({"frequency_command":30.0,"mode":"torque","brake":true,"id":"a2"})");
  EXPECT_EQ(parsed.id_text, "a2");
  EXPECT_EQ(parse_object_payload(R"({"id":7})").id_text, "7");
  const auto fields = fields_of(kPump, parsed.members.value());
  ASSERT_FALSE(fields.mistake);
  ASSERT_EQ(fields.sound.size(), 3U);
  EXPECT_EQ(fields.sound[0].signal, test::kFrequencyCommand);
  EXPECT_EQ(fields.sound[0].value, Value(30.0));
  EXPECT_EQ(fields.sound[1].signal, test::kMode);
  EXPECT_EQ(fields.sound[2].value, Value(Raw{1}));
}

TEST(Command, SetNamesWhatIsWrong) {
  const auto unknown = fields_of(kPump, {{"speed", {Scalar::Kind::number, "1"}}});
  ASSERT_TRUE(unknown.mistake);
  EXPECT_EQ(unknown.mistake->kind, ErrorKind::unknown);
  EXPECT_NE(unknown.mistake->detail.find("speed"), std::string::npos);
  ASSERT_TRUE(fields_of(kPump, {}).mistake);
  EXPECT_EQ(fields_of(kPump, {}).mistake->kind, ErrorKind::type);
  const auto two = fields_of(kPump, {{"brake", {Scalar::Kind::null, "null"}},
                                     {"mode", {Scalar::Kind::string, "torque"}},
                                     {"speed", {Scalar::Kind::number, "1"}}});
  EXPECT_EQ(two.mistake->kind, ErrorKind::type) << "the first of both";
  ASSERT_EQ(two.sound.size(), 1U);
  EXPECT_EQ(two.sound[0].signal, test::kMode);
}

TEST(Command, NmtByName) {
  EXPECT_EQ(nmt_command_of(parse_value("start").members.value()).value(), canopen::NmtCommand::start);
  EXPECT_EQ(nmt_command_of(parse_value(R"({"value":"reset-node","id":1})").members.value()).value(),
            canopen::NmtCommand::reset_node);
  for (const char* payload : {"run", "1", "true", R"({"value":129})"}) {
    EXPECT_EQ(nmt_command_of(parse_value(payload).members.value()).error().kind, ErrorKind::unknown) << payload;
  }
}

canopen::Result<SdoRequest> sdo(std::string_view payload) {
  return sdo_request_of(parse_object_payload(payload).members.value());
}

TEST(Command, SdoRead) {
  const auto request = sdo(R"({"id":"7","op":"read","object":"0x2002:03","type":"u16"})");
  ASSERT_TRUE(request.has_value());
  EXPECT_EQ(request.value().object, (canopen::ObjectAddress{0x2002, 3}));
  EXPECT_EQ(request.value().type, canopen::DataType::u16);
  EXPECT_FALSE(request.value().value);
}

TEST(Command, SdoWriteTakesRawValues) {
  const auto write = [](std::string_view type, std::string_view value) {
    return sdo(R"({"op":"write","object":"0x2002:03","type":")" + std::string(type) + R"(","value":)" +
               std::string(value) + "}");
  };
  EXPECT_EQ(write("u16", "3").value().value, Raw{3});
  EXPECT_EQ(write("i16", "-3").value().value, static_cast<Raw>(-3));
  EXPECT_EQ(write("u64", "18446744073709551615").value().value, Raw{18446744073709551615U});
  EXPECT_EQ(write("bool", "true").value().value, Raw{1});
  EXPECT_EQ(write("u8", "256").error().kind, ErrorKind::range);
  EXPECT_EQ(write("u8", "-1").error().kind, ErrorKind::range);
  EXPECT_EQ(write("u8", "true").error().kind, ErrorKind::type);
  EXPECT_EQ(write("u8", "\"1\"").error().kind, ErrorKind::type);
}

TEST(Command, SdoTakesTextAndBytes) {
  const auto write = [](std::string_view type, std::string_view value) {
    return sdo(R"({"op":"write","object":"0x2002:03","type":")" + std::string(type) + R"(","value":)" +
               std::string(value) + "}");
  };
  const auto text = write("string", R"("pump \u00e4")");
  ASSERT_TRUE(text.has_value());
  EXPECT_EQ(text.value().form, SdoForm::text);
  EXPECT_EQ(text.value().data, (std::vector<std::uint8_t>{'p', 'u', 'm', 'p', ' ', 0xC3, 0xA4}));
  EXPECT_TRUE(text.value().writes());
  const auto bytes = write("bytes", R"("00fFa1")");
  ASSERT_TRUE(bytes.has_value());
  EXPECT_EQ(bytes.value().form, SdoForm::bytes);
  EXPECT_EQ(bytes.value().data, (std::vector<std::uint8_t>{0x00, 0xFF, 0xA1}));
  for (const char* digits : {R"("0")", R"("0g")", R"("0x10")", R"("+1")", R"("")", "10", "null"}) {
    EXPECT_EQ(write("bytes", digits).error().kind, ErrorKind::type) << digits;
  }
  for (const char* value : {R"("")", "1", "true", "null"}) {
    EXPECT_EQ(write("string", value).error().kind, ErrorKind::type) << value;
  }
  const auto read = sdo(R"({"op":"read","object":"0x1008:00","type":"string"})");
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read.value().form, SdoForm::text);
  EXPECT_FALSE(read.value().writes());
}

TEST(Command, SdoShowsTextAndBytes) {
  EXPECT_EQ(sdo_text(SdoForm::text, {'A', 'C', '3', 0, 0}), "AC3") << "some devices send the zero behind a string";
  EXPECT_EQ(sdo_text(SdoForm::text, {'A', 0, 'C'}), std::string("A\0C", 3));
  EXPECT_EQ(sdo_text(SdoForm::text, {0}), "");
  EXPECT_EQ(sdo_text(SdoForm::bytes, {0x00, 0xAF, 0x05}), "00AF05");
}

TEST(Command, SdoRefusesWhatIsMissingOrUnknown) {
  EXPECT_EQ(sdo(R"({"op":"erase","object":"0x2002:03","type":"u16"})").error().kind, ErrorKind::unknown);
  for (const char* payload :
       {R"({"object":"0x2002:03","type":"u16"})", R"({"op":"read","type":"u16"})",
        R"({"op":"read","object":"2002.3","type":"u16"})", R"({"op":"read","object":"0x2002:03"})",
        R"({"op":"read","object":"0x2002:03","type":"u128"})", R"({"op":"write","object":"0x2002:03","type":"u16"})",
        R"({"op":"read","object":"0x2002:03","type":"u16","value":1})",
        R"({"op":"read","object":"0x2002:03","type":"u16","node":3})",
        R"({"op":1,"object":"0x2002:03","type":"u16"})"}) {
    EXPECT_EQ(sdo(payload).error().kind, ErrorKind::type) << payload;
  }
}

}  // namespace
}  // namespace mqtt
