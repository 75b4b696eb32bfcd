// modbus_torn READS: a drive's 32-bit value flips between 0x0000FFFF and 0xFFFF0000 a thousand times a second, and
// libmodbus' client reads it so often from the server over TCP: by functions 3 and 4, on the drive's own unit and on
// the flat one. Status 1 where one answer holds half of each. That reading the two registers one after the other does
// tear them shows that it could be seen.

#include <modbus/modbus.h>

#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "bridges/modbus/server.h"
#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/subscription.h"
#include "canopen/bus/virtual_link.h"
#include "canopen/clock.h"
#include "tests/support/puppet.h"
#include "tests/unit/modbus/site.h"

namespace {

using namespace std::chrono_literals;
using Words = std::array<std::uint16_t, 2>;

constexpr std::uint8_t kFlatUnit = 100;
constexpr std::uint16_t kFlatBase = 3000;
constexpr int kSplitReads = 4000;

void require(bool holds, const std::string& what) {
  if (!holds) {
    throw std::runtime_error(what);
  }
}

config::Model site_model() {
  config::Model model = modbus_test::example_model();
  model.drives.front().flat = kFlatBase;
  model.modbus->flat_unit = kFlatUnit;
  return model;
}

/// The gateway's plant and server with one drive on the in-process bus, on a loop in a thread of its own.
class Site {
 public:
  Site() {
    modbus_test::fill_dictionary(puppet_);
    plant_.add(server_);
    server_.start();
    bus_.start();
    plant_.start();
    puppet_.boot_up();
    flip_at(canopen::Clock::now());
    thread_ = std::thread([this] { loop_.run(); });
  }
  ~Site() {
    boost::asio::co_spawn(loop_, end(), boost::asio::use_future).wait();
    thread_.join();
  }
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  [[nodiscard]] std::uint16_t port() const { return server_.port(0); }

 private:
  boost::asio::awaitable<void> end() {
    ended_ = true;
    co_await server_.stop();
    co_await plant_.stop();
    co_await bus_.stop();
  }
  void flip_at(canopen::TimePoint due) {
    timer_.expires_at(due);
    timer_.async_wait([this, due](const boost::system::error_code& failed) {
      if (failed || ended_) {
        return;
      }
      // Flips that are late follow at once, each with a turn of the loop in between, so that what was asked meanwhile
      // is answered between them.
      ++flips_;
      const bool odd = flips_ % 2 != 0;
      values_[4] = values_[5] = odd ? 0xFF : 0;
      values_[6] = values_[7] = odd ? 0 : 0xFF;
      puppet_.tpdo(1, values_);
      if (flips_ % 100 == 1) {
        puppet_.heartbeat();
      }
      flip_at(due + 1ms);
    });
  }

  boost::asio::io_context loop_{1};
  config::Model model_ = site_model();
  canopen::VirtualBus can_{loop_.get_executor()};
  support::Puppet puppet_{can_, modbus_test::kUnit};
  canopen::Bus bus_{
      loop_.get_executor(), can_.connect(), {.bitrate = 250000, .node_id = 127, .heartbeat = {}, .sync = {}}};
  process::Plant plant_{loop_.get_executor(), model_, {{&bus_, [this] { return bus_.statistics(); }}}};
  canopen::Subscription bus_state_ =
      bus_.subscribe_state([this](const canopen::BusState& state) { plant_.set_bus_state(0, state); });
  modbus::Server server_{loop_.get_executor(), plant_, *model_.modbus};
  canopen::Timer timer_{loop_.get_executor()};
  std::array<std::uint8_t, 8> values_{};
  std::uint64_t flips_ = 0;
  bool ended_ = false;
  std::thread thread_;
};

class Reader {
 public:
  explicit Reader(std::uint16_t port) : server_(modbus_new_tcp("127.0.0.1", port), &modbus_free) {
    require(server_ != nullptr && modbus_connect(server_.get()) == 0 &&
                modbus_set_response_timeout(server_.get(), 5, 0) == 0,
            "no connection");
  }
  /// Registers of the drive's own unit, or of the flat one. False: an exception, as long as the drive is not there.
  [[nodiscard]] bool read(bool flat, bool input, std::uint16_t address, std::span<std::uint16_t> into) {
    const int count = static_cast<int>(into.size());
    const int at = address + (flat ? kFlatBase : 0);
    modbus_set_slave(server_.get(), flat ? kFlatUnit : modbus_test::kUnit);
    return (input ? modbus_read_input_registers(server_.get(), at, count, into.data())
                  : modbus_read_registers(server_.get(), at, count, into.data())) == count;
  }

 private:
  std::unique_ptr<modbus_t, decltype(&modbus_free)> server_;
};

constexpr Words kOne{0x0000, 0xFFFF};
constexpr Words kOther{0xFFFF, 0x0000};

/// The two registers each by a request of its own, as nobody should: how often they did not belong together.
int torn_when_split(Reader& client) {
  int torn = 0;
  for (int i = 0; i < kSplitReads; ++i) {
    Words words{};
    for (std::uint16_t part = 0; part < 2; ++part) {
      require(client.read(false, false, modbus_test::address::kPosition + part, std::span(words).subspan(part, 1)),
              std::string("half a value: ") + modbus_strerror(errno));
    }
    torn += words != kOne && words != kOther ? 1 : 0;
  }
  return torn;
}

void run(int reads) {
  Site site;
  Reader client(site.port());
  Words words{};
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (!client.read(false, false, modbus_test::address::kPosition, words) || words == Words{}) {
    require(std::chrono::steady_clock::now() < end, "the drive did not come online");
    std::this_thread::sleep_for(10ms);
  }
  const int split = torn_when_split(client);
  require(split > 0, "even two requests for one value never tore it: it does not flip while it is read");
  int ones = 0;
  for (int i = 0; i < reads; ++i) {
    require(client.read(i % 2 != 0, i % 4 >= 2, modbus_test::address::kPosition, words),
            "read " + std::to_string(i) + ": " + modbus_strerror(errno));
    require(words == kOne || words == kOther, "torn at read " + std::to_string(i));
    ones += words == kOne ? 1 : 0;
  }
  require(ones > reads / 10 && reads - ones > reads / 10,
          "it hardly flips: " + std::to_string(ones) + " times one value");
  std::printf("%d reads, none torn (%d and %d); of %d by two requests each, %d were\n", reads, ones, reads - ones,
              kSplitReads, split);
}

}  // namespace

int main(int argc, char** argv) {
  const int reads = argc == 2 ? std::atoi(argv[1]) : 0;
  if (reads <= 0) {
    std::fputs("usage: modbus_torn READS\n", stderr);
    return 2;
  }
  try {
    run(reads);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "modbus_torn: %s\n", error.what());
    return 1;
  }
  return 0;
}
