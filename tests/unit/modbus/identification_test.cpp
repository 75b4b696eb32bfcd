#include "bridges/modbus/identification.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "tests/unit/modbus/bytes.h"

namespace {

using modbus::EncapsulatedAnswer;
using modbus::Exception;
using modbus::IdentityId;
using modbus::IdentityObject;
using modbus_test::Bytes;
using modbus_test::hex;

const std::vector<IdentityObject> kObjects{{IdentityId::vendor_name, "v"},
                                           {IdentityId::product_code, "pc"},
                                           {IdentityId::revision, "1.0"},
                                           {IdentityId::model_name, "m"},
                                           {IdentityId::name, "pump1"},
                                           {IdentityId::serial_number, Exception::no_response},
                                           {IdentityId::hardware_version, Exception::illegal_address},
                                           {IdentityId::software_version, "s"}};

std::string ask(const std::string& request, const std::vector<IdentityObject>& objects = kObjects) {
  const EncapsulatedAnswer answer = modbus::identify(hex(request), objects);
  if (const auto* const refused = std::get_if<Exception>(&answer)) {
    return "exception " + std::to_string(static_cast<int>(*refused));
  }
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : std::get<Bytes>(answer)) {
    text += {kDigits[byte >> 4], kDigits[byte & 0xF]};
  }
  return text;
}

TEST(Identification, AStreamHasItsCategoryAndTheOnesBelow) {
  EXPECT_EQ(ask("2b 0e 01 00"),
            "2b0e0183000003"
            "000176"
            "01027063"
            "0203312e30");
  EXPECT_EQ(ask("2b 0e 02 00"),
            "2b0e0283000004"
            "000176"
            "01027063"
            "0203312e30"
            "05016d");
  EXPECT_EQ(ask("2b 0e 03 00"),
            "2b0e0383000006"
            "000176"
            "01027063"
            "0203312e30"
            "05016d"
            "800570756d7031"
            "840173");
}

TEST(Identification, AStreamBeginsWhereItIsAsked) {
  EXPECT_EQ(ask("2b 0e 01 02"),
            "2b0e0183000001"
            "0203312e30");
  EXPECT_EQ(ask("2b 0e 03 80"),
            "2b0e0383000002"
            "800570756d7031"
            "840173");
  // One that cannot be told just now is an id all the same: who reads on there does not begin anew.
  EXPECT_EQ(ask("2b 0e 03 82"),
            "2b0e0383000001"
            "840173");
}

TEST(Identification, AStreamFromAnUnknownIdBeginsAtTheFirst) {
  for (const char* const id : {"03", "7f", "80", "ff"}) {
    EXPECT_EQ(ask(std::string("2b 0e 01 ") + id), ask("2b 0e 01 00")) << id;
  }
  EXPECT_EQ(ask("2b 0e 02 80"), ask("2b 0e 02 00"));
  EXPECT_EQ(ask("2b 0e 03 85"), ask("2b 0e 03 00"));
}

TEST(Identification, AStreamFromOneThatIsNotToldAndHasNoneBehindItBeginsAtTheFirst) {
  std::vector<IdentityObject> offline = kObjects;
  for (IdentityObject& object : offline) {
    if (object.id >= IdentityId::serial_number) {
      object.text = Exception::no_response;
    }
  }
  for (const char* const pdu : {"2b 0e 03 82", "2b 0e 03 83", "2b 0e 03 84"}) {
    EXPECT_EQ(ask(pdu, offline), ask("2b 0e 03 00", offline)) << pdu;
  }
}

TEST(Identification, OneObjectAlone) {
  EXPECT_EQ(ask("2b 0e 04 01"),
            "2b0e0483000001"
            "01027063");
  EXPECT_EQ(ask("2b 0e 04 84"),
            "2b0e0483000001"
            "840173");
  EXPECT_EQ(ask("2b 0e 04 03"), "exception 2");
  EXPECT_EQ(ask("2b 0e 04 82"), "exception 11");
  EXPECT_EQ(ask("2b 0e 04 83"), "exception 2");
}

TEST(Identification, OtherCodesAndLengthsAreRefused) {
  for (const char* const pdu : {"2b 0e", "2b 0e 01", "2b 0e 01 00 00", "2b 0e 00 00", "2b 0e 05 00", "2b 0e ff 00"}) {
    EXPECT_EQ(ask(pdu), "exception 3") << pdu;
  }
}

TEST(Identification, WhatDoesNotFitFollows) {
  std::vector<IdentityObject> objects = kObjects;
  objects[1].text = std::string(100, 'a');
  objects[2].text = std::string(132, 'b');  // 7 + 3 + 102 + 134 = 246: seven are left
  objects[3].text = std::string(5, 'c');
  const std::string first = ask("2b 0e 02 00", objects);
  EXPECT_EQ(first.size(), 2U * 253);
  EXPECT_EQ(first.substr(0, 14), "2b0e0283000004");
  objects[3].text = std::string(6, 'c');
  EXPECT_EQ(ask("2b 0e 02 00", objects).substr(0, 14), "2b0e0283ff0503");
  EXPECT_EQ(ask("2b 0e 02 05", objects),
            "2b0e0283000001"
            "0506636363636363");
}

TEST(Identification, ATextThatFitsInNoAnswerIsCut) {
  std::vector<IdentityObject> objects = kObjects;
  objects[4].text = std::string(300, 'a');
  const std::string alone = ask("2b 0e 04 80", objects);
  EXPECT_EQ(alone.size(), 2U * 253);
  EXPECT_EQ(alone.substr(14, 6), "80f461");
  // In a stream it has a frame of its own.
  EXPECT_EQ(ask("2b 0e 03 00", objects).substr(0, 14), "2b0e0383ff8004");
  EXPECT_EQ(ask("2b 0e 03 80", objects).substr(0, 14), "2b0e0383ff8401");
  EXPECT_EQ(ask("2b 0e 03 84", objects),
            "2b0e0383000001"
            "840173");
}

}  // namespace
