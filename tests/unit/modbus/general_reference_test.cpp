#include "bridges/modbus/general_reference.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <variant>

#include "tests/support/spawn.h"
#include "tests/unit/modbus/site.h"

namespace {

using modbus::Exception;
using modbus::parse_reference;
using modbus::Reference;
using modbus_test::Bytes;
using modbus_test::example_model;
using modbus_test::frame;
using modbus_test::hex;
using modbus_test::kUnit;
using modbus_test::Site;
using modbus_test::TcpClient;
using std::chrono::milliseconds;

// 0x2000:01 and :02 are the command signals of the drive, 0x3000:04 is one of a single byte, 0x2FFF:00 is no signal.
constexpr canopen::ObjectAddress kOtherObject{0x2FFF, 0};
constexpr const char* kReadControl = "2b 0d 00 00 05 2000 01 0000 0000";

std::string digits(const Bytes& bytes) {
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += {kDigits[byte >> 4], kDigits[byte & 0xF]};
  }
  return text;
}

std::string shape(const std::string& pdu) {
  const Bytes bytes = hex(pdu);
  const auto parsed = parse_reference(bytes);
  const auto* const refused = std::get_if<Exception>(&parsed);
  return refused == nullptr ? "right" : "exception " + std::to_string(static_cast<int>(*refused));
}

TEST(GeneralReference, IsUnderstood) {
  const Bytes read = hex("2b 0d 00 00 7f 1018 04 0102 0304");
  const auto reading = std::get<Reference>(parse_reference(read));
  EXPECT_FALSE(reading.write);
  EXPECT_EQ(reading.node, 127);
  EXPECT_EQ(reading.object, (canopen::ObjectAddress{0x1018, 4}));
  EXPECT_EQ(reading.start, 0x0102);
  EXPECT_EQ(reading.count, 0x0304);
  const Bytes write = hex("2b 0d 01 00 05 2000 02 0000 0002 e803");
  const auto writing = std::get<Reference>(parse_reference(write));
  EXPECT_TRUE(writing.write);
  EXPECT_EQ(Bytes(writing.data.begin(), writing.data.end()), hex("e803"));
}

TEST(GeneralReference, OtherShapesAreRefused) {
  EXPECT_EQ(shape(kReadControl), "right");
  EXPECT_EQ(shape("2b 0d"), "exception 3");
  EXPECT_EQ(shape("2b 0d 00 00 05 2000 01 0000 00"), "exception 3");
  EXPECT_EQ(shape("2b 0d 00 00 05 2000 01 0000 0000 00"), "exception 3");  // a read brings nothing
  for (const char* const control : {"02", "03", "80", "81"}) {
    EXPECT_EQ(shape(std::string("2b 0d ") + control + " 00 05 2000 01 0000 0000"), "exception 3") << control;
  }
  EXPECT_EQ(shape("2b 0d 00 01 05 2000 01 0000 0000"), "exception 3");  // reserved
  EXPECT_EQ(shape("2b 0d 01 00 05 2000 01 0000 0002 0500"), "right");
  EXPECT_EQ(shape("2b 0d 01 00 05 2000 01 0000 0000"), "exception 3");       // nothing to write
  EXPECT_EQ(shape("2b 0d 01 00 05 2000 01 0000 0002 05"), "exception 3");    // less than it says
  EXPECT_EQ(shape("2b 0d 01 00 05 2000 01 0000 0001 0500"), "exception 3");  // more
  EXPECT_EQ(shape("2b 0d 01 00 05 2000 01 0001 0001 05"), "exception 3");    // a part of an object
}

std::string read_part(const std::string& start_and_count, std::size_t size) {
  const Bytes pdu = hex("2b 0d 00 00 05 1008 00 " + start_and_count);
  Bytes object;
  for (std::size_t i = 0; i < size; ++i) {
    object.push_back(static_cast<std::uint8_t>(i));
  }
  return digits(modbus::bytes_read(pdu, std::get<Reference>(parse_reference(pdu)), object));
}

TEST(GeneralReference, AReadTellsWhatFollows) {
  const std::string head = "2b0d000005100800";
  EXPECT_EQ(read_part("0000 0000", 3), head + "0000" + "0003" + "000102");
  EXPECT_EQ(read_part("0000 0002", 3), head + "0000" + "0002" + "0001");
  EXPECT_EQ(read_part("0001 0005", 3), head + "0001" + "0002" + "0102");
  EXPECT_EQ(read_part("0003 0000", 3), head + "0003" + "0000");
  EXPECT_EQ(read_part("ffff 0001", 3), head + "ffff" + "0000");
  EXPECT_EQ(read_part("0000 0000", 241).size(), 2U * 253);
  EXPECT_EQ(read_part("0000 0000", 242).substr(20, 4), "00f1");
  EXPECT_EQ(read_part("0000 ffff", 4096).size(), 2U * 253);
  EXPECT_EQ(read_part("00f1 0000", 242), head + "00f1" + "0001" + "f1");
}

TEST(GeneralReference, AnAbortIsAnExtendedException) {
  EXPECT_EQ(digits(modbus::aborted(0x06090030)), "abff00060dec06090030");
}

/// A drive whose writers may write raw objects, and what is asked of it by function 43.
class GeneralReferenceTest : public testing::Test {
 protected:
  static config::Model model(bool raw) {
    config::Model model = example_model();
    model.drives[0].commands.raw = raw;
    return model;
  }
  void begin(config::Model model) {
    site_.reset();  // Two of them would share one stopped clock.
    site_ = std::make_unique<Site>(std::move(model));
    site_->puppet().dictionary[kOtherObject] = {.value = 0x04030201, .size = 4};
    site_->bring_up();
    site_->puppet().written.clear();
  }
  [[nodiscard]] std::string ask(const std::string& pdu, std::uint8_t unit = kUnit) {
    TcpClient& client = site_->client();
    const Bytes request = frame(unit, pdu);
    EXPECT_EQ(client.send(request), request.size());
    const auto answered = [&client] {
      client.receive();
      return client.has_frame() || client.closed();
    };
    if (!site_->settle_until(answered) && !site_->loop().advance_until(answered, std::chrono::seconds(5))) {
      return "silence";
    }
    const Bytes answer = client.take_frame();
    return digits({answer.begin() + 7, answer.end()});
  }
  [[nodiscard]] auto& written() { return site_->puppet().written; }

  std::unique_ptr<Site> site_;
};

TEST_F(GeneralReferenceTest, ReadsWhatTheDriveHas) {
  begin(example_model());
  EXPECT_EQ(ask("2b 0d 00 00 05 2fff 00 0000 0000"),
            "2b0d0000052fff0000000004"
            "01020304");
  EXPECT_EQ(ask("2b 0d 00 00 05 2fff 00 0001 0002"),
            "2b0d0000052fff0000010002"
            "0203");
  EXPECT_EQ(ask("2b 0d 00 00 05 3000 05 0000 0000"),
            "2b0d00000530000500000002"
            "0700");
}

TEST_F(GeneralReferenceTest, TellsTheAbortOfTheDrive) {
  begin(model(true));
  EXPECT_EQ(ask("2b 0d 00 00 05 4444 00 0000 0000"), "abff00060dec06020000");
  site_->puppet().refuse_writes[kOtherObject] = 0x06010002;
  EXPECT_EQ(ask("2b 0d 01 00 05 2fff 00 0000 0001 07"), "abff00060dec06010002");
  EXPECT_EQ(site_->ask("03 03f4 0002"), "03 04 0601 0002");  // 1012, 1013: of the command
}

TEST_F(GeneralReferenceTest, ADriveTakesOnlyItsOwnNode) {
  begin(example_model());
  EXPECT_EQ(ask("2b 0d 00 00 06 2fff 00 0000 0000"), "ab02");
  EXPECT_EQ(ask("2b 0d 00 00 00 2fff 00 0000 0000"), "ab02");
  for (const std::uint8_t gateway : {std::uint8_t{0}, std::uint8_t{255}}) {
    EXPECT_EQ(ask("2b 0d 00 00 05 2fff 00 0000 0001", gateway), "2b0d0000052fff000000000101");
    EXPECT_EQ(ask("2b 0d 00 00 06 2fff 00 0000 0001", gateway), "ab02");
  }
}

TEST_F(GeneralReferenceTest, AWriteIsConfirmedWithItsHead) {
  begin(model(true));
  EXPECT_EQ(ask("2b 0d 01 00 05 2fff 00 0000 0004 0a0b0c0d"), "2b0d0100052fff0000000000");
  EXPECT_EQ(written().back(), (canopen::ObjectValue{kOtherObject, canopen::DataType::u32, 0x0D0C0B0A}));
  EXPECT_EQ(ask("2b 0d 01 00 05 2fff 00 0000 0003 010203", 255), "2b0d0100052fff0000000000");
  EXPECT_EQ(written().back(), (canopen::ObjectValue{kOtherObject, canopen::DataType::u32, 0x030201}));
}

TEST_F(GeneralReferenceTest, ASignalsObjectGoesTheSignalsWay) {
  begin(example_model());  // raw writes are not allowed
  EXPECT_EQ(ask("2b 0d 01 00 05 2000 02 0000 0002 e803"), "2b0d01000520000200000000");
  EXPECT_EQ(written().back().object, modbus_test::kFrequencyObject);
  EXPECT_EQ(site_->ask("03 0065 0001"), "03 02 03e8");
  written().clear();
  EXPECT_EQ(ask("2b 0d 01 00 05 2000 02 0000 0002 ffff"), "ab03");    // beyond its limit
  EXPECT_EQ(ask("2b 0d 01 00 05 2000 02 0000 0001 01"), "ab03");      // not its type
  EXPECT_EQ(ask("2b 0d 01 00 05 2000 02 0000 0003 010000"), "ab03");  // nor that
  EXPECT_EQ(ask("2b 0d 01 00 05 2000 02 0000 0004 01000000"), "ab03");
  EXPECT_TRUE(written().empty());
}

TEST_F(GeneralReferenceTest, AStopIsOneThereToo) {
  config::Model leased = example_model();
  canopen::MotorSigns& motor = leased.drives[0].node.motor;
  motor.control = modbus_test::kControlObject;
  motor.stops = {{0xFFFF, 5}};
  leased.drives[0].commands.lease = std::chrono::seconds(60);
  begin(std::move(leased));
  process::Drive& drive = site_->plant().drive(0);
  const auto another = support::spawn(
      site_->loop().executor(),
      drive.write({.writer = {.way = process::Writer::Way::modbus, .address = "10.0.0.9"}},
                  {{static_cast<process::SignalId>(*drive.model().find("control_command")), canopen::Raw{1}}}));
  site_->settle();
  ASSERT_TRUE(another.done());
  ASSERT_TRUE(another.get().has_value());
  written().clear();
  EXPECT_EQ(ask("2b 0d 01 00 05 2000 01 0000 0002 0100"), "ab01") << "he has the lease";
  EXPECT_TRUE(written().empty());
  EXPECT_EQ(ask("2b 0d 01 00 05 2000 01 0000 0002 0500"), "2b0d01000520000100000000");
  EXPECT_EQ(written().back(), (canopen::ObjectValue{modbus_test::kControlObject, canopen::DataType::u32, 5}));
}

TEST_F(GeneralReferenceTest, RawWritesNeedRaw) {
  begin(example_model());
  EXPECT_EQ(ask("2b 0d 01 00 05 2fff 00 0000 0001 07"), "ab01");
  EXPECT_EQ(ask("2b 0d 01 00 05 2fff 00 0000 0003 070000"), "ab01");
  EXPECT_TRUE(written().empty());
}

TEST_F(GeneralReferenceTest, PdoSetupIsNeverWritten) {
  begin(model(true));
  EXPECT_EQ(ask("2b 0d 01 00 05 1800 01 0000 0004 85010000"), "ab01");
  EXPECT_EQ(ask("2b 0d 01 00 05 1a00 01 0000 0003 850100"), "ab01");
  EXPECT_TRUE(written().empty());
}

TEST_F(GeneralReferenceTest, WhoMayNotWriteIsTold) {
  config::Model outside = model(true);
  outside.modbus->write_from = {{"192.0.2.0", 24}};
  begin(std::move(outside));
  EXPECT_EQ(ask("2b 0d 01 00 05 2fff 00 0000 0001 07"), "ab01");
  EXPECT_EQ(ask("2b 0d 01 00 63 2fff 00 0000 0001 07"), "ab01");  // before anything else about it
  EXPECT_EQ(ask("2b 0d 01 00 63 2fff 00 0000 0001 07", 255), "ab01");
  EXPECT_TRUE(written().empty());
  EXPECT_EQ(ask("2b 0d 00 00 05 2fff 00 0000 0001"), "2b0d0000052fff000000000101");

  config::Model none = model(true);
  none.drives[0].commands.writers = {};
  begin(std::move(none));
  EXPECT_EQ(ask("2b 0d 01 00 05 2fff 00 0000 0001 07"), "ab01");
  EXPECT_EQ(ask("2b 0d 01 00 05 2000 02 0000 0001 07"), "ab01");
  EXPECT_TRUE(written().empty());
}

TEST_F(GeneralReferenceTest, ADriveThatIsNotThereDoesNotAnswer) {
  site_ = std::make_unique<Site>(model(true));
  EXPECT_EQ(ask("2b 0d 00 00 05 2fff 00 0000 0000"), "ab0b");
  EXPECT_EQ(ask("2b 0d 01 00 05 2fff 00 0000 0001 07"), "ab0b");
  EXPECT_EQ(ask("2b 0d 01 00 05 2fff 00 0000 0003 070000"), "ab0b");
}

}  // namespace
