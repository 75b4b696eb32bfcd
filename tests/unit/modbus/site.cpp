#include "tests/unit/modbus/site.h"

#include <gtest/gtest.h>

#include <bit>
#include <boost/asio/co_spawn.hpp>
#include <chrono>
#include <exception>
#include <utility>
#include <vector>

namespace modbus_test {
namespace {

using canopen::DataType;
using config::Access;
using config::ModbusKind;
using config::Signal;
using config::SourceKind;
using std::chrono::milliseconds;

constexpr std::uint8_t kNode = 5;
constexpr canopen::ObjectAddress kStatusObject{0x2010, 1};
constexpr canopen::ObjectAddress kOutputFrequencyObject{0x2010, 2};
constexpr canopen::ObjectAddress kPositionObject{0x2010, 3};
constexpr canopen::ObjectAddress kTemperatureObject{0x2011, 1};
constexpr canopen::ObjectAddress kPowerObject{0x2011, 2};
constexpr canopen::ObjectAddress kSpeedObject{0x2011, 3};

Signal measured(std::string name, canopen::ObjectAddress object, DataType type, std::uint16_t tpdo,
                config::ModbusPlace place) {
  Signal signal;
  signal.name = std::move(name);
  signal.object = object;
  signal.type = type;
  signal.source = {.kind = SourceKind::tpdo, .number = tpdo};
  signal.modbus = place;
  return signal;
}

Signal derived(std::string name, std::uint64_t mask, std::uint16_t address) {
  Signal signal = measured(std::move(name), kStatusObject, DataType::boolean, 1, {ModbusKind::bit, address, 1, false});
  signal.derived = config::Derived{.from = 0, .mask = mask, .values = {mask}};
  return signal;
}

Signal command(std::string name, canopen::ObjectAddress object, DataType type, config::Source source,
               config::ModbusPlace place) {
  Signal signal = measured(std::move(name), object, type, 0, place);
  signal.access = Access::write;
  signal.source = source;
  return signal;
}

constexpr config::Source kSdo{SourceKind::sdo, 0};
constexpr config::Source kRpdo1{SourceKind::rpdo, 1};

config::ModbusPlace at(std::uint16_t where, std::uint16_t count = 1, bool as_float = false) {
  return {.kind = ModbusKind::holding, .address = where, .count = count, .as_float = as_float};
}

std::vector<Signal> signals() {
  std::vector<Signal> all{
      measured("status_word", kStatusObject, DataType::u16, 1, at(address::kStatusWord)),
      measured("output_frequency", kOutputFrequencyObject, DataType::i16, 1, at(address::kFrequency)),
      measured("position", kPositionObject, DataType::i32, 1, at(address::kPosition, 2)),
      measured("temperature", kTemperatureObject, DataType::i8, 2, at(address::kTemperature)),
      measured("power", kPowerObject, DataType::f32, 2, at(address::kPower, 2)),
      measured("speed", kSpeedObject, DataType::u16, 2, at(address::kSpeedFloat, 2, true)),
      derived("running", 0x0001, 0),
      derived("fault", 0x0008, 2),
      command("control_command", kControlObject, DataType::u16, kRpdo1, at(address::kControlCommand)),
      command("frequency_command", kFrequencyObject, DataType::u16, kRpdo1, at(address::kFrequencyCommand)),
      command("acceleration", kAccelerationObject, DataType::u16, kSdo, at(address::kAcceleration)),
      command("target_position", kTargetObject, DataType::i32, kSdo, at(address::kTargetPosition, 2)),
      command("limit", kLimitObject, DataType::u16, kSdo, at(address::kLimitFloat, 2, true)),
      command("jog_speed", kJogObject, DataType::i8, kSdo, at(address::kJogSpeed)),
      command("ramp", kRampObject, DataType::u16, kSdo, at(address::kRamp)),
      command("relay", kRelayObject, DataType::boolean, kSdo, {ModbusKind::bit, 10, 1, false}),
      command("valve", kValveObject, DataType::boolean, kSdo, {ModbusKind::bit, 11, 1, false}),
  };
  all[1].scale = 0.01;
  all[5].scale = 0.1;
  all[8].momentary = {0x80};
  all[9].scale = 0.01;
  all[9].min = 0.0;
  all[9].max = 50.0;
  all[12].scale = 0.01;
  all[12].max = 49.97;
  all[14].access = Access::read_write;
  return all;
}

canopen::NodeSettings node_settings() {
  canopen::NodeSettings node;
  node.node = kNode;
  node.error_control.policy = canopen::SetupPolicy::assume;
  canopen::PdoSettings fast;
  fast.number = 1;
  fast.cob_id = 0x180U + kNode;
  fast.mapping_policy = canopen::SetupPolicy::assume;
  fast.transmission_type = 254;
  fast.event_timer = 100;
  fast.period = milliseconds(100);
  fast.mapping = {{kStatusObject, DataType::u16, 16},
                  {kOutputFrequencyObject, DataType::i16, 16},
                  {kPositionObject, DataType::i32, 32}};
  canopen::PdoSettings slow;
  slow.number = 2;
  slow.cob_id = 0x280U + kNode;
  slow.communication = canopen::SetupPolicy::assume;
  slow.mapping_policy = canopen::SetupPolicy::assume;
  slow.mapping = {
      {kTemperatureObject, DataType::i8, 8}, {kPowerObject, DataType::f32, 32}, {kSpeedObject, DataType::u16, 16}};
  node.tpdos = {fast, slow};
  canopen::PdoSettings receive;
  receive.number = 1;
  receive.cob_id = 0x200U + kNode;
  receive.communication = canopen::SetupPolicy::assume;
  receive.mapping_policy = canopen::SetupPolicy::assume;
  receive.mapping = {{kControlObject, DataType::u16, 16}, {kFrequencyObject, DataType::u16, 16}};
  node.rpdos = {receive};
  return node;
}

void fill_dictionary(Puppet& puppet) {
  puppet.dictionary = {{{0x1800, 1}, {0x180U + kNode, 4}},
                       {{0x1800, 2}, {254, 1}},
                       {{0x1800, 5}, {100, 2}},
                       {{0x1017, 0}, {500, 2}},
                       {kStatusObject, {0, 2}},
                       {kOutputFrequencyObject, {0, 2}},
                       {kPositionObject, {0, 4}},
                       {kTemperatureObject, {0, 1}},
                       {kPowerObject, {0, 4}},
                       {kSpeedObject, {0, 2}},
                       {kControlObject, {0, 2}},
                       {kFrequencyObject, {0, 2}},
                       {kAccelerationObject, {0, 2}},
                       {kTargetObject, {0, 4}},
                       {kLimitObject, {0, 2}},
                       {kJogObject, {0, 1}},
                       {kRampObject, {7, 2}},
                       {kRelayObject, {0, 1}},
                       {kValveObject, {0, 1}}};
}

void put(std::span<std::uint8_t> bytes, std::uint64_t value) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

// `03 04 0001 0002`, `06 0065 1388`, `83 02`: the function, the count of bytes where there is one, words.
std::string text_of(const Bytes& frame) {
  constexpr std::size_t kFunction = 7;
  constexpr std::string_view kDigits = "0123456789abcdef";
  const std::uint8_t function = frame.at(kFunction);
  const bool counted = function <= 4 || function == 23 || function >= 0x80;
  std::string text;
  for (std::size_t i = kFunction; i < frame.size(); ++i) {
    const std::size_t within = i - kFunction;
    const bool begins = within == 1 || (counted ? within >= 2 && within % 2 == 0 : within % 2 == 1);
    text += begins && within > 0 ? " " : "";
    text += kDigits[frame[i] >> 4];
    text += kDigits[frame[i] & 0xF];
  }
  return text;
}

}  // namespace

config::Model example_model() {
  config::Model model;
  model.gateway.name = "line3";
  model.buses = {config::Bus{.name = "can0", .interface = "virtual", .bitrate = 250000, .heartbeat = {}}};
  config::Drive drive;
  drive.name = "pump1";
  drive.unit = kUnit;
  drive.node = node_settings();
  drive.signals = signals();
  drive.faults.running = 6;
  drive.faults.fault = 7;
  drive.faults.has_error_register = false;
  drive.faults.has_error_field = false;
  drive.commands.writers.modbus = true;
  model.drives = {drive};
  model.modbus = config::Modbus{};
  model.modbus->listen = {{"127.0.0.1", 0}};
  return model;
}

Site::Site(config::Model model)
    : model_(std::move(model)),
      can_(loop_.executor()),
      puppet_(can_, kNode),
      bus_(loop_.executor(), can_.connect(), {.bitrate = 250000, .node_id = 127, .heartbeat = {}, .sync = {}}),
      plant_(loop_.executor(), model_, {{&bus_, [this] { return bus_.statistics(); }}}),
      bus_state_(bus_.subscribe_state([this](const canopen::BusState& state) { plant_.set_bus_state(0, state); })),
      server_(loop_.executor(), plant_, *model_.modbus) {
  fill_dictionary(puppet_);
  plant_.add(server_);
  server_.start();
  bus_.start();
  plant_.start();
  loop_.settle();
}

Site::~Site() {
  client_.reset();
  bool done = false;
  boost::asio::co_spawn(
      loop_.executor(),
      [](Site& site) -> boost::asio::awaitable<void> {
        co_await site.server_.stop();
        co_await site.plant_.stop();
        co_await site.bus_.stop();
      }(*this),
      [&done](const std::exception_ptr& failure) {
        done = true;
        if (failure) {
          std::rethrow_exception(failure);
        }
      });
  EXPECT_TRUE(loop_.advance_until([&done] { return done; }, std::chrono::seconds(5)));
}

void Site::stop_server() {
  bool done = false;
  boost::asio::co_spawn(loop_.executor(), server_.stop(), [&done](const std::exception_ptr& failure) {
    done = true;
    if (failure) {
      std::rethrow_exception(failure);
    }
  });
  EXPECT_TRUE(loop_.advance_until([&done] { return done; }, std::chrono::seconds(5)));
}

void Site::bring_up() {
  puppet_.boot_up();
  run_without_values(milliseconds(300));
  const canopen::NodeStatus& status = plant_.drive(0).status();
  ASSERT_TRUE(status.online) << status.boot_text;
  ASSERT_EQ(status.nmt, canopen::NmtState::operational);
  send_values(0, 0, 0);
  send_slow_values(0, 0.0F, 0);
}

void Site::step(bool values) {
  puppet_.heartbeat();
  if (values) {
    puppet_.tpdo(1, values_);
  }
  loop_.advance(milliseconds(50), milliseconds(10));
}

void Site::run(canopen::Duration time) {
  for (canopen::Duration passed{}; passed < time; passed += milliseconds(50)) {
    step(true);
  }
}

void Site::run_without_values(canopen::Duration time) {
  for (canopen::Duration passed{}; passed < time; passed += milliseconds(50)) {
    step(false);
  }
}

void Site::send_values(std::uint16_t status, std::int16_t frequency, std::int32_t position) {
  put(std::span(values_).subspan<0, 2>(), status);
  put(std::span(values_).subspan<2, 2>(), static_cast<std::uint64_t>(frequency));
  put(std::span(values_).subspan<4, 4>(), static_cast<std::uint64_t>(position));
  puppet_.tpdo(1, values_);
  loop_.settle();
}

void Site::send_slow_values(std::int8_t temperature, float power, std::uint16_t speed) {
  std::array<std::uint8_t, 7> bytes{};
  put(std::span(bytes).subspan<0, 1>(), static_cast<std::uint64_t>(temperature));
  put(std::span(bytes).subspan<1, 4>(), std::bit_cast<std::uint32_t>(power));
  put(std::span(bytes).subspan<5, 2>(), speed);
  puppet_.tpdo(2, bytes);
  loop_.settle();
}

bool Site::settle_until(const std::function<bool()>& done) {
  // Real time only bounds how long a broken server may keep a test; what loopback carries is there at once.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(3);
  loop_.settle();
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) {
      return false;
    }
    loop_.settle();
  }
  return true;
}

TcpClient& Site::client() {
  if (!client_) {
    client_ = std::make_unique<TcpClient>(port());
  }
  return *client_;
}

std::string Site::answer(TcpClient& client) {
  const bool came = settle_until([&client] {
    client.receive();
    return client.has_frame() || client.closed();
  });
  if (client.has_frame()) {
    return text_of(client.take_frame());
  }
  return came ? "closed" : "silence";
}

std::string Site::ask(TcpClient& client, std::uint8_t unit, std::string_view pdu) {
  const Bytes request = frame(unit, pdu);
  EXPECT_EQ(client.send(request), request.size());
  return answer(client);
}

}  // namespace modbus_test
