#include "tests/unit/canopen/node_bench.h"

namespace canopen {

using namespace std::chrono_literals;

NodeSettings bench_settings() {
  NodeSettings settings;
  settings.node = kTestNode;
  PdoSettings tpdo;
  tpdo.cob_id = 0x185;
  tpdo.transmission_type = std::uint8_t{255};
  tpdo.event_timer = std::uint16_t{100};
  tpdo.period = std::chrono::milliseconds(100);
  tpdo.mapping = {{{0x6041, 0}, DataType::u16, 16, FieldUse::commanded},
                  {{0x6044, 0}, DataType::i16, 16, FieldUse::commanded}};
  PdoSettings rpdo;
  rpdo.cob_id = 0x205;
  rpdo.transmission_type = std::uint8_t{255};
  rpdo.mapping = {{kControlWord, DataType::u16, 16, FieldUse::commanded},
                  {kTarget, DataType::i16, 16, FieldUse::commanded}};
  settings.tpdos = {tpdo};
  settings.rpdos = {rpdo};
  return settings;
}

Frame nmt(std::uint8_t command) {
  return make_frame(0, std::vector<std::uint8_t>{command, kTestNode});
}

NodeBench::~NodeBench() {
  if (node_) {
    const std::size_t heard = slave_.heard().size();
    const auto stopped = support::spawn(loop_.executor(), node_->stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
    EXPECT_EQ(slave_.heard().size(), heard) << "an end sends nothing";
    node_.reset();
  }
  const auto stopped = support::spawn(loop_.executor(), bus_.stop());
  loop_.settle();
  EXPECT_TRUE(*stopped);
}

BusSettings NodeBench::quiet_bus() {
  BusSettings settings;
  settings.heartbeat = Duration::zero();
  return settings;
}

void NodeBench::install(const NodeSettings& settings) {
  slave_.set({0x1000, 0}, DataType::u32, 0x00010192);
  slave_.set({0x1018, 1}, DataType::u32, 0x90);
  slave_.set(kHeartbeatTime, DataType::u16, 500);
  for (const PdoSettings& pdo : settings.tpdos) {
    install(pdo, 0x1800);
  }
  for (const PdoSettings& pdo : settings.rpdos) {
    install(pdo, 0x1400);
  }
  slave_.set(kControlWord, DataType::u16, 0);
  slave_.set(kTarget, DataType::i16, 0);
}

void NodeBench::install(const PdoSettings& pdo, std::uint16_t base) {
  const auto communication = static_cast<std::uint16_t>(base + pdo.number - 1);
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  slave_.set({communication, 1}, DataType::u32, pdo.cob_id | 0x4000'0000U);
  slave_.set({communication, 2}, DataType::u8, pdo.transmission_type.value_or(254));
  slave_.set({communication, 3}, DataType::u16, pdo.inhibit_time.value_or(0));
  slave_.set({communication, 5}, DataType::u16, pdo.event_timer.value_or(0));
  slave_.set({mapping, 0}, DataType::u8, pdo.mapping.size());
  std::uint8_t sub = 0;
  for (const MappedObject& mapped : pdo.mapping) {
    slave_.set({mapping, ++sub}, DataType::u32,
               (Raw{mapped.object.index} << 16U) | (Raw{mapped.object.sub} << 8U) | mapped.bits);
  }
}

void NodeBench::running(const NodeSettings& settings) {
  install(settings);
  slave_.set_state(5);
}

void NodeBench::start(const NodeSettings& settings) {
  node_ = std::make_unique<RemoteNode>(loop_.executor(), bus_, settings, events_);
  node_->start();
  loop_.settle();
}

void NodeBench::boot(const NodeSettings& settings) {
  start(settings);
  slave_.boot_up();
  loop_.advance(2s);
}

void NodeBench::bring_online(const NodeSettings& settings) {
  install(settings);
  start(settings);
  slave_.boot_up();
  ASSERT_TRUE(wait_online()) << status().boot_text;
  // The first heartbeat that says so, and the end of the time in which another state is no wonder.
  loop_.advance(std::chrono::milliseconds(2100));
  slave_.forget_heard();
}

bool NodeBench::wait_online(Duration limit) {
  return loop_.advance_until([this] { return status().online; }, limit);
}

void NodeBench::send_tpdo(std::uint16_t status_word, std::uint16_t speed) {
  slave_.send(0x185, {static_cast<std::uint8_t>(status_word & 0xFFU), static_cast<std::uint8_t>(status_word >> 8U),
                      static_cast<std::uint8_t>(speed & 0xFFU), static_cast<std::uint8_t>(speed >> 8U)});
  loop_.settle();
}

void NodeBench::lose() {
  slave_.unplug(true);
  loop_.advance(2100ms);
  ASSERT_TRUE(status().lost);
  slave_.forget_heard();
}

void NodeBench::expect_untouched() {
  EXPECT_TRUE(slave_.writes().empty());
  EXPECT_TRUE(nmt_heard().empty());
  EXPECT_TRUE(slave_.heard_on(0x205).empty());
}

void NodeBench::expect_letter(BootResult letter, const std::string& text_part) {
  EXPECT_FALSE(status().online);
  EXPECT_EQ(status().boot_result, letter) << static_cast<char>(status().boot_result) << " " << status().boot_text;
  EXPECT_NE(status().boot_text.find(text_part), std::string::npos) << status().boot_text;
  EXPECT_TRUE(nmt_heard().empty()) << "a node that could not be configured is not started";
}

void NodeBench::expect_left_alone(const std::string& text_part) {
  expect_letter(BootResult::left_alone, text_part);
  expect_untouched();
}

NodeCommandBench::Sent NodeCommandBench::command(NmtCommand command, Duration within) {
  return support::spawn(loop_.executor(), node_->command(command, Clock::now() + within));
}

Result<void> NodeCommandBench::command_now(NmtCommand what) {
  const auto sent = command(what);
  loop_.advance(5ms);
  EXPECT_TRUE(sent.done());
  return sent.done() ? sent.get() : Result<void>(Error{});
}

NodeCommandBench::Sent NodeCommandBench::write(Raw raw, Duration within) {
  return support::spawn(loop_.executor(), node_->write(kControlWord, DataType::u16, raw, Clock::now() + within));
}

NodeCommandBench::Sent NodeCommandBench::rpdo(std::vector<ObjectValue> fields, Duration within) {
  return support::spawn(loop_.executor(), send_and_note(std::move(fields), Clock::now() + within));
}

boost::asio::awaitable<Result<void>> NodeCommandBench::send_and_note(std::vector<ObjectValue> fields,
                                                                     TimePoint deadline) {
  Result<void> left = co_await node_->send_rpdo(1, fields, TransmitClass::command, deadline);
  if (left.has_value()) {
    events_.repeated = std::move(fields);
  }
  co_return left;
}

Result<void> NodeCommandBench::rpdo_now(std::vector<ObjectValue> fields) {
  const auto sent = rpdo(std::move(fields));
  loop_.advance(2ms);
  EXPECT_TRUE(sent.done());
  return sent.done() ? sent.get() : Result<void>(Error{});
}

void NodeCommandBench::expect_write_refused() {
  const std::size_t heard = slave_.heard_on(0x605).size();
  const auto writing = write(6);
  loop_.settle();
  ASSERT_TRUE(writing.done()) << "refused at once";
  EXPECT_EQ(writing.get().error().kind, ErrorKind::offline);
  EXPECT_EQ(slave_.heard_on(0x605).size(), heard);
}

}  // namespace canopen
