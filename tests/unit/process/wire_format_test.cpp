// Everything that the gateway sends, read by a decoder that shares no code with it.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "canopen/sdo/client.h"
#include "tests/support/block_server.h"
#include "tests/support/recording_link.h"
#include "tests/support/tshark.h"
#include "tests/unit/process/simulated_bus.h"

namespace process {
namespace {

using namespace std::chrono_literals;
using canopen::NmtCommand;
using Bytes = std::vector<std::uint8_t>;

/// What tshark calls malformed or does not know, and how often each kind of frame was there.
struct Verdict {
  std::vector<std::string> objections;
  std::map<std::string, std::size_t> kinds;
};

Verdict verdict_on(const std::vector<canopen::Received>& sent) {
  Verdict verdict;
  for (const support::Decoded& decoded : support::decode_by_tshark(sent)) {
    if (decoded.malformed || decoded.info.find("Unknown") != std::string::npos) {
      verdict.objections.push_back(decoded.frame + ": " + decoded.info);
    }
    ++verdict.kinds[decoded.info.substr(0, decoded.info.find(" ["))];
  }
  return verdict;
}

void expect_well_formed(const Verdict& verdict, const std::vector<std::string>& kinds) {
  EXPECT_EQ(verdict.objections, std::vector<std::string>{});
  for (const std::string& kind : kinds) {
    EXPECT_TRUE(verdict.kinds.contains(kind)) << kind << " was not sent";
  }
}

canopen::Received frame_of(std::uint32_t id, const Bytes& bytes) {
  return {canopen::make_frame(id, bytes), {}, {}};
}

// What is asserted of the others would be no news otherwise.
TEST(WireFormat, AMalformedFrameIsNoticed) {
  EXPECT_EQ(verdict_on({frame_of(0x605, {0x40, 0x18, 0x10, 0x04})}).objections.size(), 1U) << "no eight bytes";
  EXPECT_EQ(verdict_on({frame_of(0x000, {0x01})}).objections.size(), 1U) << "for whom?";
  EXPECT_EQ(verdict_on({frame_of(0x000, {0x07, 0x05})}).objections.size(), 1U) << "no such command";
  EXPECT_EQ(verdict_on({frame_of(0x605, {0xE0, 0, 0, 0, 0, 0, 0, 0})}).objections.size(), 1U);
  EXPECT_TRUE(verdict_on({frame_of(0x605, {0x40, 0x18, 0x10, 0x04, 0, 0, 0, 0})}).objections.empty());
}

class WireFormatTest : public SimulatedBus {
 protected:
  static std::string drive(const std::string& name, int node, const std::string& profile,
                           const std::string& keys = "") {
    return "[[drive]]\nname = \"" + name + "\"\nnode = " + std::to_string(node) + "\nprofile = \"" + profile + "\"\n" +
           keys + "[drive.commands]\nwriters = [\"modbus\"]\nraw = true\nnmt_while_running = true\n";
  }
};

TEST_F(WireFormatTest, OfBootsCommandsStopsAndSupervision) {
  load(drive("mixer1", 5, "cia402-velocity", "supervise_gateway = \"2s\"\n[drive.rpdo1]\nevent_timer = \"300ms\"\n") +
           drive("hoist1", 7, "invt-goodrive600", "guarding = \"500ms\"\n") + drive("pump1", 3, "veichi-ac310") +
           drive("fan1", 9, "vacon-opte6"),
       "sync = \"100ms\"\n");
  for (const config::Drive& each : model_.drives) {
    add(each.profile, each.node.node);
  }
  drives_[1]->misbehaviour().absent = {{0x1017, std::nullopt}};
  for (const auto& simulated : drives_) {
    simulated->power_on();
  }
  start();
  ASSERT_TRUE(wait_online());
  run(3s);
  for (const canopen::Raw word : {6U, 7U, 15U}) {
    EXPECT_TRUE(write({{"control_command", word}, {"target_velocity", 600}}).has_value());
  }
  run(2s);
  EXPECT_TRUE(write({{"target_velocity", 700}}).has_value());
  EXPECT_TRUE(stop_motor().has_value());
  EXPECT_TRUE(write({{"frequency_command", 100}}, 2).has_value()) << "by SDO";
  const auto name = support::spawn(loop_.executor(), plant_->drive(0).sdo_read({0x1008, 0}));
  EXPECT_TRUE(loop_.advance_until([&] { return name.done(); }, 2s));
  for (const NmtCommand command : {NmtCommand::pre_operational, NmtCommand::start, NmtCommand::stop, NmtCommand::start,
                                   NmtCommand::reset_communication, NmtCommand::reset_node}) {
    EXPECT_TRUE(nmt(command).has_value()) << canopen::name_of(command);
    run(4s);
  }
  const bool guarded = std::ranges::any_of(sent_, [](const auto& sent) { return sent.frame.remote; });
  EXPECT_TRUE(guarded);
  expect_well_formed(
      verdict_on(sent_),
      {"NMT: Start remote node", "NMT: Stop remote node", "NMT: Enter pre-operational state", "NMT: Reset node",
       "NMT: Reset communication", "NMT Error Control: Operational", "SYNC", "PDO1 (rx)",
       "Default-SDO (rx): Initiate upload request", "Default-SDO (rx): Initiate download request",
       "Default-SDO (rx): Upload segment request", "ID: 1799 (0x707), Length: 1(Remote Transmission Request)"});
}

/// An SDO server, node 5, on an in-process bus, and a client of it.
class SdoWire final : private canopen::LinkEvents {
 public:
  SdoWire() : link_(wire_.connect()) {
    link_->open(*this);
    bus_.start();
    loop_.advance(2ms);
  }
  ~SdoWire() {
    const auto stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
  }
  SdoWire(const SdoWire&) = delete;
  SdoWire& operator=(const SdoWire&) = delete;

  /// An object of that length is read and written.
  void exchange(std::size_t size, bool block) {
    canopen::SdoSettings settings;
    settings.block = block;
    canopen::SdoClient client(loop_.executor(), bus_, 5, settings);
    Bytes data(size);
    std::iota(data.begin(), data.end(), std::uint8_t{1});
    server.objects[kObject] = data;
    const auto read = support::spawn(loop_.executor(), client.read_bytes(kObject, 0));
    loop_.advance(4s);
    EXPECT_TRUE(read.done());
    static_cast<void>(link_->send(canopen::make_frame(0x705, Bytes{5})));  // Commands leave on a bus that lives.
    loop_.advance(1ms);
    const auto written =
        support::spawn(loop_.executor(), client.write_command(kObject, data, canopen::Clock::now() + 800ms));
    loop_.advance(1s);
    EXPECT_TRUE(written.done());
    client.close();
    loop_.settle();
  }

  support::BlockServer server{5};
  std::vector<canopen::Received> sent;

 private:
  static constexpr canopen::ObjectAddress kObject{0x2000, 1};

  void on_frames(std::span<const canopen::Received> frames) override {
    for (const canopen::Received& received : frames) {
      for (const canopen::Frame& answer : server.answer(received.frame)) {
        static_cast<void>(link_->send(answer));
      }
    }
  }
  void on_echo(const canopen::Received&) override {}
  void on_bus_state(const canopen::BusState&) override {}
  void on_frames_lost(std::uint32_t) override {}

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  std::unique_ptr<canopen::Link> link_;
  canopen::Bus bus_{loop_.executor(), std::make_unique<support::RecordingLink>(wire_.connect(), sent), {}};
};

TEST(WireFormat, OfSdoInAllModesAndItsAborts) {
  SdoWire wire;
  wire.server.faults.block_sizes = {30};
  for (const std::size_t size : {1U, 2U, 4U, 5U, 7U, 8U, 29U, 60U, 400U}) {
    wire.exchange(size, false);
    wire.exchange(size, true);
  }
  wire.server.faults.wrong_crc = true;
  wire.exchange(100, true);
  wire.server.faults.wrong_crc = false;
  wire.server.faults.frames_until_silence = 1;  // A transfer that is accepted and goes no further.
  wire.exchange(100, false);
  const Verdict verdict = verdict_on(wire.sent);
  expect_well_formed(verdict, {"Default-SDO (rx): Initiate upload request", "Default-SDO (rx): Upload segment request",
                               "Default-SDO (rx): Initiate download request",
                               "Default-SDO (rx): Download segment request", "Default-SDO (rx): Block upload",
                               "Default-SDO (rx): Block download", "Default-SDO (rx): Abort transfer"});
  const auto aborts = [&](std::uint32_t code) {
    return std::ranges::count_if(wire.sent, [code](const canopen::Received& sent) {
      std::uint32_t found = 0;
      for (unsigned i = 0; i < 4; ++i) {
        found |= std::uint32_t{sent.frame.data[4 + i]} << (8 * i);
      }
      return sent.frame.id == 0x605 && sent.frame.data[0] == 0x80 && found == code;
    });
  };
  EXPECT_GE(aborts(0x05040004), 1) << "a wrong check sum";
  EXPECT_GE(aborts(0x05040000), 1) << "no answer in time";
}

}  // namespace
}  // namespace process
