// Any bytes a client may send, in any pieces and at any moment, to the server before a plant with live drives. Whatever
// they are: each request is answered once, in order, in the shape that the standards give; nothing but a write reaches
// the drive, nothing at all the drive that takes no commands; and no answer holds half of one value and half of
// another.
//
// An input is a row of items. The first byte says what it is:
//   1wo mmmmm  unit, length, PDU: a request with a right header. o: its answer is not waited for. w: the drive that
//   takes
//              commands is mute from now on, or no longer.
//   01tttttt   50 ms times t pass.
//   00nnnnnn   n bytes as they are, without waiting.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "bridges/modbus/mbap.h"
#include "bridges/modbus/server.h"
#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "tests/fuzz/byte_input.h"
#include "tests/fuzz/modbus_answer.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/puppet.h"
#include "tests/support/spawn.h"
#include "tests/unit/modbus/site.h"
#include "tests/unit/modbus/tcp_client.h"

namespace {

using namespace std::chrono_literals;
using fuzz::Bytes;
using fuzz::require;
using modbus_test::TcpClient;

constexpr std::size_t kMaxItems = 48;  // More would test patience only.
constexpr std::uint8_t kPump = modbus_test::kUnit;
constexpr std::uint8_t kFan = 6;

// `pump1` takes commands by Modbus, `fan1` takes none; unit 100 shows both.
config::Model site_model() {
  config::Model model = modbus_test::example_model();
  config::Drive& pump = model.drives.front();
  pump.flat = 3000;
  pump.commands.raw = true;
  pump.node.motor.control = modbus_test::kControlObject;
  pump.node.motor.stops = {{.equals = 5}};
  config::Drive fan = pump;
  fan.name = "fan1";
  fan.unit = fan.node.node = kFan;
  fan.flat = 4000;
  fan.node.tpdos[0].cob_id = 0x180U + kFan;
  fan.node.tpdos[1].cob_id = 0x280U + kFan;
  fan.node.rpdos[0].cob_id = 0x200U + kFan;
  fan.commands.writers = {};
  model.drives.push_back(std::move(fan));
  model.modbus->flat_unit = 100;
  model.modbus->idle_timeout = 0s;
  return model;
}

std::size_t effects_on(const support::Puppet& drive) {
  return drive.rpdos.size() + drive.written.size() + drive.nmt_commands.size();
}

class Site {
 public:
  Site();
  ~Site();
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  void send(Bytes bytes);
  void pass(canopen::Duration time);
  /// Time passes until all that was asked is answered.
  void drain();
  void turn_mute() {
    pump_.mute = !pump_.mute;
    was_mute_ = true;
  }

 private:
  void step();
  void take_answers();
  void check(Bytes request, Bytes answer) const;
  void check_whole(Bytes request, Bytes answer) const;
  void end(boost::asio::awaitable<void> stop);

  support::HandDrivenLoop loop_;
  config::Model model_ = site_model();
  canopen::VirtualBus can_{loop_.executor()};
  support::Puppet pump_{can_, kPump};
  support::Puppet fan_{can_, kFan};
  canopen::Bus bus_{loop_.executor(), can_.connect(), {.bitrate = 250000, .node_id = 127, .heartbeat = {}, .sync = {}}};
  process::Plant plant_{loop_.executor(), model_, {{&bus_, [this] { return bus_.statistics(); }}}};
  modbus::Server server_{loop_.executor(), plant_, *model_.modbus};
  std::unique_ptr<TcpClient> client_;
  std::vector<std::uint8_t> unfinished_;           ///< Sent, and no whole frame yet.
  bool garbage_ = false;                           ///< Sent: the server will close.
  std::deque<std::vector<std::uint8_t>> awaited_;  ///< Frames without an answer.
  canopen::TimePoint half_since_;                  ///< Of what is unfinished.
  std::size_t pump_was_told_ = 0;                  ///< By its start.
  std::size_t fan_was_told_ = 0;
  bool wrote_ = false;
  bool was_mute_ = false;
  bool odd_ = false;
};

Site::Site() {
  modbus_test::fill_dictionary(pump_);
  modbus_test::fill_dictionary(fan_);
  fan_.dictionary[{0x1800, 1}] = {0x180U + kFan, 4};
  plant_.add(server_);
  server_.start();
  bus_.start();
  plant_.start();
  loop_.settle();
  plant_.set_bus_state(0, bus_.state());
  pump_.boot_up();
  fan_.boot_up();
  pass(300ms);
  require(plant_.online() == 2);
  pump_was_told_ = effects_on(pump_);
  fan_was_told_ = effects_on(fan_);
}

Site::~Site() {
  client_.reset();
  end(server_.stop());
  end(plant_.stop());
  end(bus_.stop());
}

void Site::end(boost::asio::awaitable<void> stop) {
  const auto done = support::spawn(loop_.executor(), std::move(stop));
  require(loop_.advance_until([&done] { return *done; }, 5s));
}

void Site::step() {
  odd_ = !odd_;
  const std::uint8_t low = odd_ ? 0xFF : 0x00;
  const std::uint8_t high = odd_ ? 0x00 : 0xFF;
  const std::array<std::uint8_t, 8> values{0x01, 0, low, 0, low, low, high, high};
  for (support::Puppet* const drive : {&pump_, &fan_}) {
    drive->heartbeat();
    drive->tpdo(1, values);
    drive->tpdo(2, std::array<std::uint8_t, 7>{});
  }
  loop_.advance(50ms, 10ms);
  take_answers();
}

void Site::pass(canopen::Duration time) {
  for (canopen::Duration passed{}; passed < time; passed += 50ms) {
    step();
  }
}

void Site::send(Bytes bytes) {
  if (!client_) {
    // The timer by which libFuzzer watches an input may interrupt one.
    for (int tries = 0; tries < 3 && (!client_ || !client_->connected()); ++tries) {
      client_ = std::make_unique<TcpClient>(server_.port(0));
    }
    require(client_->connected());
    loop_.settle();
  }
  require(client_->send(bytes) == bytes.size());
  if (unfinished_.empty()) {
    half_since_ = canopen::Clock::now();
  }
  unfinished_.insert(unfinished_.end(), bytes.begin(), bytes.end());
  modbus::FoundFrame found = modbus::find_frame(unfinished_);
  for (; found.framing == modbus::Framing::complete; found = modbus::find_frame(unfinished_)) {
    const auto frame_end = unfinished_.begin() + static_cast<std::ptrdiff_t>(found.size);
    awaited_.emplace_back(unfinished_.begin(), frame_end);
    wrote_ = wrote_ || fuzz::may_write(modbus::pdu_of(awaited_.back()));
    unfinished_.erase(unfinished_.begin(), frame_end);
    half_since_ = canopen::Clock::now();
  }
  garbage_ = garbage_ || found.framing == modbus::Framing::broken;
  loop_.settle();
  take_answers();
  if (garbage_) {
    drain();  // Nothing behind it is read.
  }
}

void Site::take_answers() {
  if (!client_) {
    return;
  }
  client_->receive();
  while (client_->has_frame()) {
    require(!awaited_.empty());
    const modbus_test::Bytes answer = client_->take_frame();
    check(awaited_.front(), answer);
    awaited_.pop_front();
  }
  if (client_->closed()) {
    const bool half = !unfinished_.empty() && canopen::Clock::now() - half_since_ > 4s;
    require(awaited_.empty() && (garbage_ || half));
    client_.reset();
    unfinished_.clear();
    garbage_ = false;
  }
}

void Site::drain() {
  const auto open = [this] { return !awaited_.empty() || garbage_; };
  for (canopen::Duration passed{}; passed < 20s && open(); passed += 50ms) {
    const std::size_t before = awaited_.size();
    step();
    passed = awaited_.size() < before ? canopen::Duration{} : passed;
  }
  // What loopback carries is there at once, but for a machine that is busy: real time bounds that alone.
  for (const auto limit = std::chrono::steady_clock::now() + 3s; open() && std::chrono::steady_clock::now() < limit;) {
    loop_.settle();
    take_answers();
  }
  require(awaited_.empty() && !garbage_);
  require(effects_on(fan_) == fan_was_told_);
  // A drive that was lost is set up anew.
  require(wrote_ || was_mute_ || effects_on(pump_) == pump_was_told_);
}

void Site::check(Bytes request, Bytes answer) const {
  require(answer.size() >= modbus::kHeaderSize + 2 && answer.size() <= modbus::kMaxFrame);
  // Transaction, protocol, and behind the length the unit.
  require(std::ranges::equal(answer.first(4), request.first(4)) && answer[6] == request[6]);
  fuzz::check_answer(modbus::pdu_of(request), modbus::pdu_of(answer));
  check_whole(request, answer);
}

// The two words of `position` are each other's opposite, always.
void Site::check_whole(Bytes request, Bytes answer) const {
  const Bytes asked = modbus::pdu_of(request);
  const Bytes told = modbus::pdu_of(answer);
  const bool reads_words = (asked[0] == 3 || asked[0] == 4) && told[0] == asked[0];
  const std::size_t unit = modbus::unit_of(request);
  if (!reads_words || (unit != kPump && unit != kFan && unit != 100)) {
    return;
  }
  const std::size_t from = modbus::word_at(asked, 1);
  const std::size_t count = modbus::word_at(asked, 3);
  for (const std::size_t base : {0U, 3000U, 4000U}) {
    const std::size_t at = base + modbus_test::address::kPosition;
    if ((unit == 100) == (base != 0) && from <= at && at + 2 <= from + count) {
      const std::size_t place = 2 + 2 * (at - from);
      require((modbus::word_at(told, place) ^ modbus::word_at(told, place + 2)) == 0xFFFF);
    }
  }
}

void send_request(Site& site, fuzz::ByteInput& input, std::uint8_t transaction) {
  const std::uint8_t unit = input.byte();
  const Bytes pdu = input.bytes(std::min<std::size_t>(input.byte(), modbus::kMaxPdu));
  if (pdu.empty()) {
    return;
  }
  std::vector<std::uint8_t> frame{0x12, transaction, 0, 0, 0, static_cast<std::uint8_t>(pdu.size() + 1), unit};
  frame.insert(frame.end(), pdu.begin(), pdu.end());
  site.send(frame);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint8_t kRequest = 0x80;
  constexpr std::uint8_t kTime = 0x40;
  fuzz::ByteInput input(Bytes(data, size));
  Site site;
  for (std::size_t i = 0; i < kMaxItems && !input.empty(); ++i) {
    const std::uint8_t kind = input.byte();
    if (kind < kTime) {
      site.send(input.bytes(kind));
    } else if (kind < kRequest) {
      site.pass((kind & 0x3F) * 50ms);
    } else {
      if ((kind & 0x40) != 0) {
        site.turn_mute();
      }
      send_request(site, input, static_cast<std::uint8_t>(i));
      if ((kind & 0x20) == 0) {
        site.drain();
      }
    }
  }
  site.drain();
  return 0;
}
