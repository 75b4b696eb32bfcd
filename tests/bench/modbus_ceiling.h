#pragma once

#include <modbus/modbus.h>

#include <atomic>
#include <cstdint>
#include <thread>

namespace bench {

/// What libmodbus alone can do: select, modbus_receive, modbus_reply from a mapping that nobody changes.
class BareModbusServer {
 public:
  explicit BareModbusServer(std::uint16_t port);
  ~BareModbusServer();
  BareModbusServer(const BareModbusServer&) = delete;
  BareModbusServer& operator=(const BareModbusServer&) = delete;

  /// The thread that serves.
  [[nodiscard]] std::thread& thread() noexcept { return thread_; }

 private:
  void serve();

  modbus_t* context_;
  modbus_mapping_t* mapping_;
  int listener_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace bench
