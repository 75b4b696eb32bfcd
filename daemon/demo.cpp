#include <unistd.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <exception>
#include <string>
#include <utility>

#include "daemon/commands.h"
#include "daemon/demo_config.h"
#include "daemon/demo_screen.h"
#include "daemon/demo_site.h"
#include "daemon/descriptors.h"
#include "daemon/gateway.h"
#include "daemon/in_process_buses.h"
#include "daemon/log.h"
#include "daemon/output.h"
#include "daemon/simulated_site.h"
#include "daemon/stop_signal.h"
#include "daemon/temporary_directory.h"
#include "daemon/terminal.h"

namespace gateway {
namespace {

config::Loaded load_demo(const Options& options) {
  config::LoadOptions load = load_options(options);
  load.with_secrets = true;
  if (options.config_given) {
    config::Loaded loaded = config::load(load);
    show_findings(loaded.findings);
    return loaded;
  }
  load.file = "demo.toml";
  config::Loaded loaded = config::load_text(demo_config(), load);
  // Its warnings tell a plant what to look at; a demo has none to lose.
  if (!loaded.model) {
    show_findings(loaded.findings);
  }
  return loaded;
}

}  // namespace

int demo(const Options& options) {
  // Before anything is told or made: whoever sees a line of ours may end us, and the directory is to go.
  outlive_job_control();
  boost::asio::io_context loop(1);
  StopSignal stop(loop.get_executor(), StopSignal::HangUp::ends_it);
  config::Loaded loaded = load_demo(options);
  if (!loaded.model) {
    return kConfigurationError;
  }
  config::Model* const model = &*loaded.model;
  const Ports plant = make_demo(*model, options.config_given ? DemoOf::given_site : DemoOf::itself);
  std::string guide;
  for (const std::string& told : step_aside(*model, plant)) {
    guide += told + "\n";
  }
  // The demo leaves no trace, and does not get in the way of the gateway that this machine may run.
  const TemporaryDirectory directory;
  model->gateway.control = (directory.path() / "control").string();
  model->gateway.state_dir = (directory.path() / "state").string();
  const Log log(options.verbose);
  InProcessBuses buses(loop.get_executor(), *model);
  LiveOutput output(STDOUT_FILENO, [&stop] { stop.stop(); });
  const auto show = [&output](std::string_view text) { output.write(text); };
  SimulatedSite site(loop.get_executor(), show);
  try {
    buses.add_drives(site);
  } catch (const NotSimulated& reason) {
    complain(reason.what());
    return kConfigurationError;
  }
  Gateway gateway(loop.get_executor(), *model, [&](const config::Bus& bus) { return buses.connect(bus); }, "");
  guide = demo_guide(*model, loaded.notes) + guide;
  DemoScreen screen(loop.get_executor(), gateway.plant(), std::move(guide), show, isatty(STDOUT_FILENO) == 1);
  screen.start();  // before the log has a line: it begins with the address of the page
  gateway.start();
  site.start();
  boost::asio::co_spawn(
      loop,
      [](Gateway& running, StopSignal& told) -> boost::asio::awaitable<void> {
        co_await told.wait();
        co_await running.stop();
      }(gateway, stop),
      [&](const std::exception_ptr& error) {
        if (error) {
          std::rethrow_exception(error);
        }
        screen.stop();
        site.stop();
        loop.stop();
      });
  loop.run();
  output.require_written();
  return kDone;
}

}  // namespace gateway
