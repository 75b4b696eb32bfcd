#include "bridges/net/access_list.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <string>

namespace {

using boost::asio::ip::make_address;
using net::AccessList;

bool allows(const AccessList& list, const char* address) {
  return list.contains(make_address(address));
}

TEST(AccessList, ComparesThePrefix) {
  const AccessList list({{"192.168.4.0", 22}, {"10.1.2.3", 32}, {"2001:db8:8000::", 33}}, "key");
  EXPECT_TRUE(allows(list, "192.168.4.1"));
  EXPECT_TRUE(allows(list, "192.168.7.255"));
  EXPECT_FALSE(allows(list, "192.168.8.0"));
  EXPECT_FALSE(allows(list, "192.168.3.255"));
  EXPECT_TRUE(allows(list, "10.1.2.3"));
  EXPECT_FALSE(allows(list, "10.1.2.2"));
  EXPECT_TRUE(allows(list, "2001:db8:8000::1"));
  EXPECT_TRUE(allows(list, "2001:db8:ffff::1"));
  EXPECT_FALSE(allows(list, "2001:db8:7fff::1"));
}

TEST(AccessList, EachKindOfAddressForItself) {
  const AccessList any_v4({{"0.0.0.0", 0}}, "key");
  EXPECT_TRUE(allows(any_v4, "203.0.113.9"));
  EXPECT_FALSE(allows(any_v4, "::1"));
  const AccessList any_v6({{"::", 0}}, "key");
  EXPECT_TRUE(allows(any_v6, "::1"));
  EXPECT_FALSE(allows(any_v6, "127.0.0.1"));
  EXPECT_FALSE(allows(AccessList({}, "key"), "127.0.0.1"));
}

TEST(AccessList, WholeAddressOfIpv6) {
  const AccessList list({{"::1", 128}}, "key");
  EXPECT_TRUE(allows(list, "::1"));
  EXPECT_FALSE(allows(list, "::2"));
}

TEST(AccessList, EveryPrefixOfBothKinds) {
  for (unsigned prefix = 1; prefix <= 32; ++prefix) {
    const std::uint32_t last = 1U << (32 - prefix);  // the lowest bit within the prefix
    const AccessList list({{"255.255.255.255", prefix}}, "key");
    EXPECT_TRUE(list.contains(boost::asio::ip::address_v4(0xFFFFFFFFU - (last - 1)))) << prefix;
    EXPECT_FALSE(list.contains(boost::asio::ip::address_v4(0xFFFFFFFFU - last))) << prefix;
  }
  for (unsigned prefix = 1; prefix <= 128; ++prefix) {
    boost::asio::ip::address_v6::bytes_type bytes{};
    const AccessList list({{"::", prefix}}, "key");
    bytes.at((prefix - 1) / 8) = static_cast<unsigned char>(0x80U >> ((prefix - 1) % 8));
    EXPECT_FALSE(list.contains(boost::asio::ip::address_v6(bytes))) << prefix;
    if (prefix < 128) {
      bytes = {};
      bytes.at(prefix / 8) = static_cast<unsigned char>(0x80U >> (prefix % 8));
      EXPECT_TRUE(list.contains(boost::asio::ip::address_v6(bytes))) << prefix;
    }
  }
}

TEST(AccessList, ALinkLocalAddressWithItsInterface) {
  EXPECT_TRUE(allows(AccessList({{"fe80::", 10}}, "key"), "fe80::1%1"));
}

TEST(AccessList, APrefixLongerThanTheAddressIsNoNetwork) {
  EXPECT_THROW(AccessList({{"10.0.0.0", 33}}, "key"), std::runtime_error);
  EXPECT_THROW(AccessList({{"::", 129}}, "key"), std::runtime_error);
}

TEST(AccessList, AMappedAddressIsTheIpv4Address) {
  EXPECT_EQ(net::plain_address(make_address("::ffff:192.0.2.7")), make_address("192.0.2.7"));
  EXPECT_EQ(net::plain_address(make_address("2001:db8::7")), make_address("2001:db8::7"));
}

TEST(AccessList, NamesTheKeyOfWhatIsNoAddress) {
  try {
    const AccessList list({{"localhost", 8}}, "[modbus] write_from");
    FAIL() << "taken";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("[modbus] write_from"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("localhost"), std::string::npos);
  }
}

}  // namespace
