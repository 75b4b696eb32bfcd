#include <gtest/gtest.h>
#include <modbus/modbus.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::kUnit;
using modbus_test::Site;

struct FreeContext {
  void operator()(modbus_t* context) const noexcept {
    modbus_close(context);
    modbus_free(context);
  }
};

// A client of another make, which waits for its answers, on a thread of its own.
class LibmodbusClient {
 public:
  explicit LibmodbusClient(std::uint16_t port) : context_(modbus_new_tcp("127.0.0.1", port)) {
    modbus_set_response_timeout(context_.get(), 5, 0);
    note("connect", modbus_connect(context_.get()), 0);
  }

  void run_all() {
    modbus_t* const context = context_.get();
    std::array<std::uint16_t, 125> registers{};
    std::array<std::uint8_t, 2000> bits{};
    modbus_set_slave(context, kUnit);
    note("read_registers", modbus_read_registers(context, 0, 3, registers.data()), 3);
    note("value of register 2", registers[2], 0x1385);
    note("read_input_registers", modbus_read_input_registers(context, 200, 2, registers.data()), 2);
    note("read_bits", modbus_read_bits(context, 0, 5, bits.data()), 5);
    note("value of bit 0", bits[0], 1);
    note("read_input_bits", modbus_read_input_bits(context, 0, 200, bits.data()), 200);
    note("write_register", modbus_write_register(context, 300, 77), 1);
    const std::array<std::uint16_t, 2> commands{3, 5000};
    note("write_registers", modbus_write_registers(context, 100, 2, commands.data()), 2);
    note("mask_write", modbus_mask_write_register(context, 100, 0x00FF, 0x0100), 1);
    note("read back", modbus_read_registers(context, 100, 2, registers.data()), 2);
    note("masked value", registers[0], 0x0103);
    note("write_bit", modbus_write_bit(context, 10, 1), 1);
    const std::array<std::uint8_t, 2> coils{0, 1};
    note("write_bits", modbus_write_bits(context, 10, 2, coils.data()), 2);
    note("write_and_read", modbus_write_and_read_registers(context, 101, 1, commands.data(), 100, 2, registers.data()),
         2);
    note("largest read", modbus_read_registers(context, 1000, 100, registers.data()), 100);
    note("refused write", modbus_write_register(context, 0, 1), -1);
    note("its exception", errno, EMBXILADD);
    modbus_set_slave(context, 9);
    note("foreign unit", modbus_read_registers(context, 0, 1, registers.data()), -1);
    note("its exception", errno, EMBXGPATH);
    modbus_set_slave(context, 255);
    note("gateway", modbus_read_registers(context, 1, 1, registers.data()), 1);
    note("drives", registers[0], 1);
  }

  [[nodiscard]] const std::vector<std::string>& mismatches() const noexcept { return mismatches_; }

 private:
  void note(const std::string& what, int found, int expected) {
    if (found != expected) {
      mismatches_.push_back(what + ": " + std::to_string(found) + ", expected " + std::to_string(expected));
    }
  }

  std::unique_ptr<modbus_t, FreeContext> context_;
  std::vector<std::string> mismatches_;
};

TEST(LibmodbusClientTest, EveryFunctionWorks) {
  Site site;
  site.bring_up();
  site.send_values(0x0001, 4997, 70000);
  std::atomic<bool> done = false;
  std::vector<std::string> mismatches;
  std::thread thread([&] {
    LibmodbusClient client(site.port());
    client.run_all();
    mismatches = client.mismatches();
    done = true;
  });
  while (!done) {
    site.settle();
    std::this_thread::yield();
  }
  thread.join();
  EXPECT_EQ(mismatches, std::vector<std::string>{});
}

}  // namespace
