#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "canopen/sdo/client.h"
#include "tests/support/gated_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/scripted_slave.h"
#include "tests/support/spawn.h"

namespace canopen {

constexpr std::uint8_t kSdoNode = 5;
constexpr ObjectAddress kStatus{0x2030, 3};
constexpr ObjectAddress kCommand{0x2030, 2};
constexpr ObjectAddress kName{0x1008, 0};

inline BusSettings quiet_bus() {
  BusSettings settings;
  settings.heartbeat = Duration::zero();
  return settings;
}

/// An SDO client and a scripted slave on an in-process bus.
class SdoBench : public testing::Test {
 protected:
  using Bytes = support::ScriptedSlave::Bytes;
  using Answers = std::vector<Bytes>;

  SdoBench() {
    slave_.set({0x1017, 0}, DataType::u16, 100);  // Commands leave only while the bus shows life.
    bus_.start();
    loop_.advance(std::chrono::milliseconds(2));
  }
  ~SdoBench() override {
    client_->close();
    loop_.settle();
    EXPECT_TRUE(client_->idle());
    client_.reset();
    const auto stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
  }

  void use(SdoSettings settings) {
    client_ = std::make_unique<SdoClient>(loop_.executor(), bus_, kSdoNode, settings);
    client_->on_abort([this](std::uint32_t code) { aborts_.push_back(code); });
    client_->on_remark([this](std::string_view text) { remarks_.emplace_back(text); });
  }
  /// The node answers every request with `answers`.
  void answer_with(Answers answers) {
    slave_.script([answers](const Bytes&) { return std::optional(answers); });
  }
  support::Spawned<Result<Raw>> read(ObjectAddress object, DataType type) {
    return support::spawn(loop_.executor(), client_->read(object, type));
  }
  support::Spawned<Result<void>> write(ObjectAddress object, DataType type, Raw raw) {
    return support::spawn(loop_.executor(), client_->write(object, type, raw));
  }
  support::Spawned<Result<void>> command(ObjectAddress object, Raw raw,
                                         Duration within = std::chrono::milliseconds(800)) {
    return support::spawn(loop_.executor(), client_->write_command(object, DataType::u16, raw, Clock::now() + within));
  }
  Result<Raw> read_now(ObjectAddress object, DataType type) {
    const auto reading = read(object, type);
    loop_.advance(std::chrono::milliseconds(5));
    EXPECT_TRUE(reading.done());
    return reading.done() ? reading.get() : Result<Raw>(Error{});
  }
  Result<void> command_now(ObjectAddress object, Raw raw) {
    const auto writing = command(object, raw);
    loop_.advance(std::chrono::milliseconds(5));
    EXPECT_TRUE(writing.done());
    return writing.done() ? writing.get() : Result<void>(Error{});
  }

  support::HandDrivenLoop loop_;
  VirtualBus wire_{loop_.executor()};
  bool closed_ = false;  ///< Nothing of ours can leave.
  Bus bus_{loop_.executor(), std::make_unique<support::GatedLink>(wire_.connect(), closed_), quiet_bus()};
  support::ScriptedSlave slave_{loop_.executor(), wire_, kSdoNode};
  std::unique_ptr<SdoClient> client_ = std::make_unique<SdoClient>(loop_.executor(), bus_, kSdoNode, SdoSettings{});
  std::vector<std::uint32_t> aborts_;
  std::vector<std::string> remarks_;
};

}  // namespace canopen
