#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>

#include "canopen/bus/virtual_link.h"
#include "config/model.h"
#include "daemon/gateway.h"
#include "daemon/simulated_site.h"

namespace bench {

/// A loopback port that nobody listens on.
[[nodiscard]] std::uint16_t free_port();

/// The demo's configuration with Modbus on `modbus_port` and MQTT on `broker_port`, 0: without; every change published.
[[nodiscard]] config::Model demo_model(std::uint16_t modbus_port, std::uint16_t broker_port);

/// The gateway and the demo's simulated drives on an in-process bus, on a loop in a thread of its own.
class SiteInThread {
 public:
  explicit SiteInThread(config::Model model);
  ~SiteInThread();
  SiteInThread(const SiteInThread&) = delete;
  SiteInThread& operator=(const SiteInThread&) = delete;

  [[nodiscard]] const config::Model& model() const noexcept { return model_; }
  /// Runs `work` on the loop and waits for it.
  void on_loop(const std::function<void()>& work);
  /// False when not all drives came online in time.
  [[nodiscard]] bool wait_online();
  /// By the gateway, since its start.
  [[nodiscard]] std::uint64_t frames_received();
  [[nodiscard]] canopen::VirtualBus& bus() noexcept { return bus_; }
  [[nodiscard]] boost::asio::io_context& loop() noexcept { return loop_; }
  /// The thread of the loop.
  [[nodiscard]] std::thread& thread() noexcept { return thread_; }

 private:
  config::Model model_;
  boost::asio::io_context loop_{1};
  canopen::VirtualBus bus_{loop_.get_executor()};
  gateway::SimulatedSite drives_{loop_.get_executor()};
  gateway::Gateway gateway_;
  std::thread thread_;
};

}  // namespace bench
