#include <spdlog/spdlog.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <csignal>
#include <exception>
#include <memory>
#include <vector>

#include "canopen/bus/socketcan/socketcan_link.h"
#include "canopen/bus/virtual_link.h"
#include "daemon/commands.h"
#include "daemon/gateway.h"
#include "daemon/log.h"
#include "daemon/log_losses.h"
#include "daemon/passed_sockets.h"
#include "daemon/reload/reload.h"
#include "daemon/stop_signal.h"
#include "daemon/supervision.h"

namespace gateway {
namespace {

// Left to itself this signal would end a gateway without its goodbye. One that comes before is kept until now.
void reload_on(boost::asio::signal_set& hang_ups, Reload& reload) {
  hang_ups.async_wait([&hang_ups, &reload](const boost::system::error_code& error, int /*signal*/) {
    if (!error) {
      reload.request();
      reload_on(hang_ups, reload);
    }
  });
}

void warn_of_virtual_buses(const config::Model& model) {
  for (const config::Bus& bus : model.buses) {
    if (bus.interface == config::kVirtualInterface) {
      spdlog::warn(
          "bus {}: interface \"virtual\" is a bus inside this process, where no drive can be; it is for `demo`, which "
          "simulates them",
          bus.name);
    }
  }
}

boost::asio::awaitable<void> serve(Gateway& gateway, Reload& reload, Supervision& supervision, StopSignal& stop) {
  co_await stop.wait();
  spdlog::info("stopping");
  supervision.stopping();
  co_await reload.stop();
  co_await gateway.stop();
}

}  // namespace

int run(const Options& options) {
  // Before anything is told: whoever sees a line of ours may end us, in order.
  boost::asio::io_context loop(1);
  StopSignal stop(loop.get_executor());
  boost::asio::signal_set hang_ups(loop, SIGHUP);
  std::optional<config::Model> loaded = load_or_complain(options, Secrets::read);
  if (!loaded) {
    return kConfigurationError;
  }
  const auto model = std::make_shared<const config::Model>(*std::move(loaded));
  const Log log(options.verbose);
  warn_of_virtual_buses(*model);
  std::vector<std::unique_ptr<canopen::VirtualBus>> in_process;  // One for each bus that wants it.
  Gateway gateway(loop.get_executor(), model, [&](const config::Bus& bus) {
    if (bus.interface == config::kVirtualInterface) {
      return in_process.emplace_back(std::make_unique<canopen::VirtualBus>(loop.get_executor()))->connect();
    }
    return canopen::make_socketcan_link(
        loop.get_executor(), bus.interface,
        [name = bus.name](const std::string& text) { spdlog::warn("bus {}: {}", name, text); }, bus.echo);
  });
  gateway.start(passed_sockets());
  const LogLosses losses(loop.get_executor(), &Log::dropped, [](std::size_t lost, std::size_t all) {
    spdlog::warn("{} log messages were lost, {} since the start: whoever takes them was too slow", lost, all);
  });
  Supervision supervision(loop.get_executor(), gateway.plant(), [&gateway] { return gateway.alive(); });
  supervision.ready();
  Reload reload(loop.get_executor(), gateway,
                {.load =
                     [load = load_options(options)] {
                       config::LoadOptions now = load;
                       now.with_secrets = true;
                       return config::load(now);
                     },
                 .begins = [&supervision] { supervision.reloading(); },
                 .ends = [&supervision] { supervision.ready(); }});
  reload.start();
  reload_on(hang_ups, reload);
  spdlog::info("canopen-gateway {} serves {} as \"{}\"", GATEWAY_VERSION, config::summary(*model).substr(4),
               model->gateway.name);
  boost::asio::co_spawn(loop, serve(gateway, reload, supervision, stop), [&](const std::exception_ptr& error) {
    if (error) {
      std::rethrow_exception(error);
    }
    loop.stop();
  });
  loop.run();
  spdlog::info("stopped; {} log messages were dropped", Log::dropped());
  return kDone;
}

}  // namespace gateway
