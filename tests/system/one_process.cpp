// one_process CONFIG PROFILE-DIR DIRECTORY: the plant of a configuration, its drives simulated, in one process and
// without CAN: what the demo is, but under the plant's own name, with its own ports and brokers, for pages that show
// those. The control socket is DIRECTORY/control, state is kept in DIRECTORY/state. Orders to the drives come by
// standard input.

#include <unistd.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>

#include "daemon/gateway.h"
#include "daemon/in_process_buses.h"
#include "daemon/log.h"
#include "daemon/options.h"
#include "daemon/output.h"
#include "daemon/simulated_site.h"
#include "daemon/stop_signal.h"

namespace {

int run(const gateway::Options& options, const std::filesystem::path& directory) {
  boost::asio::io_context loop(1);
  gateway::StopSignal stop(loop.get_executor());
  std::optional<config::Model> model = gateway::load_or_complain(options, gateway::Secrets::read);
  if (!model) {
    return gateway::kConfigurationError;
  }
  std::filesystem::create_directories(directory);
  model->gateway.control = (directory / "control").string();
  model->gateway.state_dir = (directory / "state").string();
  const gateway::Log log(false);
  gateway::InProcessBuses buses(loop.get_executor(), *model);
  gateway::LiveOutput output(STDOUT_FILENO, [&stop] { stop.stop(); });
  gateway::SimulatedSite site(loop.get_executor(), [&output](std::string_view text) { output.write(text); });
  buses.add_drives(site);
  gateway::Gateway running(loop.get_executor(), *model, [&](const config::Bus& bus) { return buses.connect(bus); }, "");
  running.start();
  site.start();
  boost::asio::co_spawn(
      loop,
      [](gateway::Gateway& ended, gateway::StopSignal& told) -> boost::asio::awaitable<void> {
        co_await told.wait();
        co_await ended.stop();
      }(running, stop),
      [&](const std::exception_ptr& error) {
        if (error) {
          std::rethrow_exception(error);
        }
        site.stop();
        loop.stop();
      });
  loop.run();
  return gateway::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: one_process CONFIG PROFILE-DIR DIRECTORY\n", stderr);
    return gateway::kUsage;
  }
  try {
    return run({.config = argv[1], .config_given = true, .profile_dirs = {argv[2]}}, argv[3]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return gateway::kFailed;
  }
}
