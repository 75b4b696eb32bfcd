#include "bridges/modbus/request.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "tests/unit/modbus/bytes.h"

namespace {

using modbus::Exception;
using modbus::Function;
using modbus::parse_request;
using modbus::Range;
using modbus::Request;
using modbus_test::Bytes;
using modbus_test::hex;

// The request is a view into the bytes: both are kept.
struct Parsed {
  explicit Parsed(const std::string& text) : pdu(hex(text)), result(parse_request(pdu)) {}
  [[nodiscard]] const Request& request() const { return std::get<Request>(result); }
  [[nodiscard]] Bytes values() const { return {request().values.begin(), request().values.end()}; }

  Bytes pdu;
  std::variant<Request, Exception> result;
};

std::string verdict(const std::string& text) {
  const Parsed parsed(text);
  const auto* const refused = std::get_if<Exception>(&parsed.result);
  return refused == nullptr ? "right" : "exception " + std::to_string(static_cast<int>(*refused));
}

std::string times(std::size_t count, const std::string& text) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) {
    all += text;
  }
  return all;
}

TEST(Request, ReadsAreUnderstood) {
  const Parsed registers("03 0002 000a");
  EXPECT_EQ(registers.request().function, Function::read_holding_registers);
  EXPECT_EQ(registers.request().read, (Range{.address = 2, .quantity = 10}));
  EXPECT_TRUE(registers.request().reads());
  EXPECT_FALSE(registers.request().writes());
  EXPECT_FALSE(registers.request().of_bits());
  EXPECT_TRUE(Parsed("02 0000 0008").request().of_bits());
}

TEST(Request, WritesAreUnderstood) {
  EXPECT_EQ(Parsed("06 0065 1388").values(), hex("1388"));
  EXPECT_EQ(Parsed("06 0065 1388").request().write, (Range{.address = 0x65, .quantity = 1}));
  EXPECT_EQ(Parsed("05 000a ff00").values(), hex("01"));
  EXPECT_EQ(Parsed("05 000a 0000").values(), hex("00"));
  EXPECT_EQ(Parsed("0f 000a 0009 02 ff01").values(), hex("ff01"));
  EXPECT_EQ(Parsed("0f 000a 0009 02 ff01").request().write, (Range{.address = 10, .quantity = 9}));
  EXPECT_EQ(Parsed("10 0064 0002 04 00031388").values(), hex("00031388"));
  EXPECT_EQ(Parsed("16 0064 fff0 0003").request().and_mask, 0xFFF0);
  EXPECT_EQ(Parsed("16 0064 fff0 0003").request().or_mask, 0x0003);
  const Parsed both("17 0002 0003 0064 0001 02 1388");
  EXPECT_EQ(both.request().read, (Range{.address = 2, .quantity = 3}));
  EXPECT_EQ(both.request().write, (Range{.address = 100, .quantity = 1}));
  EXPECT_EQ(both.values(), hex("1388"));
}

TEST(Request, OtherFunctionsAreRefused) {
  for (const char* const pdu : {"00", "07", "08 0000 0000", "0b", "0c", "11", "14 00", "18 0000", "2b 00", "2b 0c 00",
                                "2b 0f", "64", "7f", "80", "83", "ab 0e 01 00", "ff"}) {
    EXPECT_EQ(verdict(pdu), "exception 1") << pdu;
  }
}

TEST(Request, WhatIsEncapsulatedComesWhole) {
  for (const char* const pdu : {"2b 0e 01 00", "2b 0d", "2b 0d 00 00 05 2000 01 0000 0000"}) {
    const Parsed parsed(pdu);
    EXPECT_EQ(parsed.request().function, Function::encapsulated_interface);
    EXPECT_TRUE(parsed.request().is_encapsulated());
    EXPECT_FALSE(parsed.request().reads());
    EXPECT_FALSE(parsed.request().writes());
    EXPECT_EQ(Bytes(parsed.request().encapsulated.begin(), parsed.request().encapsulated.end()), hex(pdu));
  }
  EXPECT_FALSE(Parsed("03 0000 0001").request().is_encapsulated());
  EXPECT_EQ(verdict("2b"), "exception 3");
}

TEST(Request, QuantitiesHaveTheLimitsOfTheStandard) {
  EXPECT_EQ(verdict("03 0000 0000"), "exception 3");
  EXPECT_EQ(verdict("03 0000 007d"), "right");
  EXPECT_EQ(verdict("03 0000 007e"), "exception 3");
  EXPECT_EQ(verdict("04 0000 ffff"), "exception 3");
  EXPECT_EQ(verdict("01 0000 0000"), "exception 3");
  EXPECT_EQ(verdict("01 0000 07d0"), "right");
  EXPECT_EQ(verdict("02 0000 07d1"), "exception 3");
  EXPECT_EQ(verdict("10 0000 0000 00"), "exception 3");
  EXPECT_EQ(verdict("10 0000 007b f6" + times(123, "0001")), "right");
  EXPECT_EQ(verdict("10 0000 007c f8" + times(124, "0001")), "exception 3");
  EXPECT_EQ(verdict("0f 0000 07b0 f6" + times(246, "00")), "right");
  EXPECT_EQ(verdict("0f 0000 07b1 f7" + times(247, "00")), "exception 3");
  EXPECT_EQ(verdict("0f 0000 0000 00"), "exception 3");
  EXPECT_EQ(verdict("17 0000 007d 0000 0079 f2" + times(121, "0001")), "right");
  EXPECT_EQ(verdict("17 0000 007d 0000 007a f4" + times(122, "0001")), "exception 3");
  EXPECT_EQ(verdict("17 0000 007e 0000 0001 02 0001"), "exception 3");
  EXPECT_EQ(verdict("17 0000 0000 0000 0001 02 0001"), "exception 3");
  EXPECT_EQ(verdict("17 0000 0001 0000 0000 00"), "exception 3");
}

TEST(Request, NothingIsMissingAndNothingLeftOver) {
  for (const char* const whole : {"03 0000 0001", "06 0000 0001", "05 0000 ff00", "0f 0000 0009 02 ffff",
                                  "10 0000 0002 04 00010002", "16 0000 0000 0000", "17 0000 0001 0000 0001 02 0001"}) {
    ASSERT_EQ(verdict(whole), "right") << whole;
    const Bytes pdu = hex(whole);
    for (std::size_t size = 1; size < pdu.size(); ++size) {
      const auto cut = parse_request(std::span(pdu).first(size));
      ASSERT_TRUE(std::holds_alternative<Exception>(cut)) << whole << " cut to " << size;
      EXPECT_EQ(std::get<Exception>(cut), Exception::illegal_value);
    }
    EXPECT_EQ(verdict(std::string(whole) + "00"), "exception 3") << whole;
  }
}

TEST(Request, TheCountOfBytesMustBeTrue) {
  EXPECT_EQ(verdict("10 0000 007b f6 0001"), "exception 3");  // claims 246 bytes, brings two
  EXPECT_EQ(verdict("10 0000 0002 02 0001"), "exception 3");
  EXPECT_EQ(verdict("10 0000 0001 02 00010002"), "exception 3");
  EXPECT_EQ(verdict("0f 0000 0008 02 ffff"), "exception 3");
  EXPECT_EQ(verdict("0f 0000 0009 01 ff"), "exception 3");
  EXPECT_EQ(verdict("17 0000 0001 0000 0002 02 0001"), "exception 3");
}

TEST(Request, ACoilIsOnOrOff) {
  EXPECT_EQ(verdict("05 0000 0001"), "exception 3");
  EXPECT_EQ(verdict("05 0000 ff01"), "exception 3");
  EXPECT_EQ(verdict("05 0000 00ff"), "exception 3");
}

TEST(Request, AddressesEndAt65535) {
  EXPECT_EQ(verdict("03 ffff 0001"), "right");
  EXPECT_EQ(verdict("03 ffff 0002"), "exception 2");
  EXPECT_EQ(verdict("01 f830 07d0"), "right");
  EXPECT_EQ(verdict("01 f831 07d0"), "exception 2");
  EXPECT_EQ(verdict("10 ffff 0002 04 00010002"), "exception 2");
  EXPECT_EQ(verdict("0f ffff 0002 01 03"), "exception 2");
  EXPECT_EQ(verdict("17 ffff 0002 0000 0001 02 0001"), "exception 2");
  EXPECT_EQ(verdict("17 0000 0001 ffff 0002 04 00010002"), "exception 2");
}

TEST(Request, AnEmptyPduIsRefused) {
  EXPECT_EQ(std::get<Exception>(parse_request({})), Exception::illegal_function);
}

}  // namespace
