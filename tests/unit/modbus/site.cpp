#include "tests/unit/modbus/site.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <boost/asio/co_spawn.hpp>
#include <chrono>
#include <exception>
#include <utility>
#include <vector>

#include "tests/support/change_plant.h"

namespace modbus_test {
namespace {

using std::chrono::milliseconds;

constexpr std::uint8_t kPuppetNode = 5;

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

Site::Site(config::Model model, std::vector<int> passed)
    : model_(std::move(model)),
      can_(loop_.executor()),
      puppet_(can_, kPuppetNode),
      bus_(loop_.executor(), can_.connect(), {.bitrate = 250000, .node_id = 127, .heartbeat = {}, .sync = {}}),
      plant_(loop_.executor(), model_, ports(model_)),
      bus_state_(bus_.subscribe_state([this](const canopen::BusState& state) { plant_.set_bus_state(0, state); })),
      server_(loop_.executor(), plant_, *model_.modbus,
              {.info = [this](const std::string& text) { notices_.push_back("info: " + text); },
               .warning = [this](const std::string& text) { notices_.push_back("warning: " + text); }}) {
  fill_dictionary(puppet_);
  plant_.add(server_);
  plant_.add(remarks_);
  server_.start(passed);
  bus_.start();
  plant_.start();
  loop_.settle();
}

std::vector<process::Plant::BusPort> Site::ports(const config::Model& model) {
  return {model.buses.size(), {&bus_, [this] { return bus_.statistics(); }}};
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

std::size_t Site::noticed(const std::string& part) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      notices_, [&part](const std::string& notice) { return notice.find(part) != std::string::npos; }));
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

void Site::change(config::Model model) {
  std::vector<process::Plant::BusPort> ports_of_all = ports(model);
  support::change_plant(loop_, plant_, std::move(model), std::move(ports_of_all));
  loop_.settle();
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
